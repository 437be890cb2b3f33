"""How good is a lookup between the nodes of a table?

A table of 5 by 3 points; the lookup is compared with a solve at a place between them.
"""

import pathlib

import matplotlib.pyplot as plt
import numpy as np

import kufe

pathlib.Path("case.toml").write_text(kufe.Case.example().to_toml())
pathlib.Path("front.toml").write_text("""case = "case.toml"
[axes]
fz_n = { values = [250.0, 500.0, 1000.0, 2000.0, 4000.0] }
radius_m = { values = [inf, 80.0, 50.0] }
[accuracy]
checks = 2
""")
table = kufe.fill_table("front.toml")
looked_up_pa, error_pa, outside = table.lookup(1400.0, 1.0 / 65.0)
solved = kufe.press(kufe.Case.example().replace({"load.fz_n": 1400.0, "track.radius_m": 65.0}))
difference = float(looked_up_pa) / solved.p_max_pa - 1.0
print(f"lookup {float(looked_up_pa) / 1e6:.1f} ± {float(error_pa) / 1e6:.1f} MPa, solve {solved.p_max_pa / 1e6:.1f} MPa: {100 * difference:+.2f} %")
assert not outside and abs(difference) < 0.02

loads_n = np.geomspace(250.0, 4000.0, 100)
figure, axes = plt.subplots(layout="constrained")
for radius_m in [np.inf, 80.0, 50.0]:
    axes.plot(loads_n, table.lookup(loads_n, 1.0 / radius_m)[0] / 1e6, label=f"track radius {radius_m:g} m")
axes.set(xlabel="normal force [N]", ylabel="peak pressure [MPa]")
axes.legend()
figure.savefig("table.png", dpi=120)
