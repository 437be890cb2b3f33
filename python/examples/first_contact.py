# %% [markdown]
# # From a runner to a table
# One contact, then how its peak pressure depends on load and track. Open this file as a notebook (Jupytext, VS Code),
# or run it: `python first_contact.py`.

# %%
import pathlib

import matplotlib.pyplot as plt
import numpy as np

import kufe

# %% [markdown]
# A bobsled runner (rocker 30 m, section 5 mm) on 50 mm of ice under 1 kN. No mesh is chosen: the case states how
# accurate the peak must be, and the result how accurate it is.

# %%
case = kufe.Case.example()
contact = kufe.press(case, accuracy=0.002)
print(contact)
print(f"p_max = {contact.p_max_pa / 1e6:.1f} +- {contact.p_max_error_pa / 1e6:.1f} MPa")

# %%
figure, (plan, cut) = plt.subplots(2, 1, figsize=(8, 5.5), layout="constrained")
field = plan.pcolormesh(
    contact.x_m * 1e3, contact.y_m * 1e3, contact.pressure_pa / 1e6, shading="gouraud", cmap="viridis"
)
figure.colorbar(field, ax=plan, label="pressure [MPa]")
half = np.array([-0.6, 0.6])
plan.set(
    xlim=half * contact.length_m * 1e3,
    ylim=half * contact.width_m * 1e3,
    xlabel="along the runner [mm]",
    ylabel="across [mm]",
    title=f"{contact.length_m * 1e3:.1f} mm x {contact.width_m * 1e3:.2f} mm under {contact.fz_n:.0f} N",
)
middle = np.argmin(np.abs(contact.y_m))
cut.plot(contact.x_m * 1e3, contact.pressure_pa[middle] / 1e6)
cut.set(
    xlim=half * contact.length_m * 1e3,
    ylim=(0, None),
    xlabel="along the runner [mm]",
    ylabel="pressure on the keel [MPa]",
)
cut.grid(alpha=0.3)
figure.savefig("contact.png", dpi=120)

# %% [markdown]
# A lookup table over force and curvature is what a simulator reads. A table file defines it; solved points are stored
# next to the table, so that an interrupted call resumes.

# %%
pathlib.Path("case.toml").write_text(case.to_toml())
pathlib.Path("table.toml").write_text("""
case = "case.toml"
[axes]
fz_n = { values = [250.0, 1000.0, 4000.0] }
curvature_1pm = { values = [-0.02, 0.0, 0.02] }
""")
table = kufe.fill_table("table.toml", "front.lut")
print(table)

# %%
force = np.linspace(250.0, 4000.0, 200)
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
for curvature in (-0.02, 0.0, 0.02):
    p_max, _, _ = table.lookup(force, curvature)
    name = "straight" if curvature == 0 else f"{'valley' if curvature > 0 else 'crest'} of 50 m"
    axes.plot(force / 1e3, p_max / 1e6, label=name)
axes.set(xlabel="normal force [kN]", ylabel="peak pressure [MPa]", ylim=(0, None))
axes.grid(alpha=0.3)
axes.legend()
figure.savefig("table.png", dpi=120)
