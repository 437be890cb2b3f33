"""Which section of a bobsled runner presses least?

The peak pressure over the section radius, on a straight and in a valley of 40 m.
"""

import matplotlib.pyplot as plt

import kufe

case = kufe.Case.example()
radii_m = [0.005, 0.006, 0.007, 0.008]
figure, axes = plt.subplots(layout="constrained")
for label, track_radius_m in [("straight", float("inf")), ("valley of 40 m", 40.0)]:
    peaks_pa = []
    for radius_m in radii_m:
        changed = {"runner.shape.section_radius_m": radius_m, "track.radius_m": track_radius_m}
        peaks_pa.append(kufe.press(case.replace(changed)).p_max_pa)
    print(label, [f"{peak / 1e6:.0f} MPa" for peak in peaks_pa])
    assert all(a > b for a, b in zip(peaks_pa, peaks_pa[1:])), "a blunter section presses less"
    axes.plot([1e3 * r for r in radii_m], [p / 1e6 for p in peaks_pa], "o-", label=label)
axes.set(xlabel="section radius [mm]", ylabel="peak pressure [MPa]")
axes.legend()
figure.savefig("sections.png", dpi=120)
