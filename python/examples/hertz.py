"""How close is the peak pressure to Hertz's closed form?

A sphere of radius R on a half-space: p_max = (6 F E*^2 / (pi^3 R^2))^(1/3), E* = E / (1 - nu^2).
K. L. Johnson, Contact Mechanics, 1985, equation 4.24.
"""

import matplotlib.pyplot as plt
import numpy as np

import kufe

RADIUS_M, MODULUS_PA, POISSON = 0.1, 9.0e9, 0.33
CASE = f"""
[runner]
shape = {{ kind = "paraboloid", rocker_radius_m = {RADIUS_M}, section_radius_m = {RADIUS_M} }}
[ice]
youngs_modulus_pa = {MODULUS_PA}
poissons_ratio = {POISSON}
thickness_m = "half-space"
[load]
fz_n = 1000.0
"""

loads_n = np.array([250.0, 500.0, 1000.0, 2000.0])
contact_modulus = MODULUS_PA / (1.0 - POISSON**2)
hertz_pa = (6.0 * loads_n * contact_modulus**2 / (np.pi**3 * RADIUS_M**2)) ** (1.0 / 3.0)
solved = [kufe.press(kufe.Case(CASE).replace({"load.fz_n": float(load)})) for load in loads_n]
peaks_pa = np.array([contact.p_max_pa for contact in solved])
errors_pa = np.array([contact.p_max_error_pa for contact in solved])

for load, peak, error, truth in zip(loads_n, peaks_pa, errors_pa, hertz_pa):
    print(f"{load:6.0f} N: {peak / 1e6:.2f} +- {error / 1e6:.2f} MPa, Hertz {truth / 1e6:.2f} MPa")
assert np.all(np.abs(peaks_pa - hertz_pa) <= errors_pa)

figure, axes = plt.subplots(layout="constrained")
axes.errorbar(loads_n, peaks_pa / 1e6, errors_pa / 1e6, fmt="o", label="kufe")
axes.plot(loads_n, hertz_pa / 1e6, label="Hertz")
axes.set(xlabel="normal force [N]", ylabel="peak pressure [MPa]")
axes.legend()
figure.savefig("hertz.png", dpi=120)
