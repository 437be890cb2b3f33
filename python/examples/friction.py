"""How does friction on yielding ice depend on the speed?

The groove is ploughed at the ice's hardness; the film of melt water is sheared. Nothing is fitted.
"""

import matplotlib.pyplot as plt

import kufe

case = kufe.Case.example().replace({"load.tilt": "fixed"})
speeds_mps = [5.0, 15.0, 30.0]
results = [kufe.slide(case, speed, -5.0, accuracy=0.05).result for speed in speeds_mps]
for speed, result in zip(speeds_mps, results):
    print(f"{speed:4.0f} m/s: mu = {1e3 * result['mu']:.2f}e-3, ploughing {1e3 * result['mu_ploughing']:.2f}e-3")
    assert abs(result["mu_ploughing"] + result["mu_viscous"] - result["mu"]) < 1e-9

figure, axes = plt.subplots(layout="constrained")
for key, label in [("mu", "total"), ("mu_ploughing", "ploughing"), ("mu_viscous", "melt film")]:
    axes.plot(speeds_mps, [1e3 * result[key] for result in results], "o-", label=label)
axes.set(xlabel="speed [m/s]", ylabel="coefficient of friction [1e-3]", ylim=(0, None))
axes.legend()
figure.savefig("friction.png", dpi=120)
