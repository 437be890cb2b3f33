"""Evaluation and discovery."""

import json
import os
import pathlib

import numpy as np
import pytest

import kufe

MODEL = """
[sled]
mass_kg = 390.0
j_yy_kgm2 = 145.0
j_zz_kgm2 = 150.0
l_f_m = 0.82
l_r_m = 0.88
cda_m2 = 0.28
[friction.longitudinal]
mu = 0.004
[friction.front]
mu_zeta = 2.577
c = 0.024
e = 0.99
k_n_per_rad = 10522.0
[friction.rear]
mu_zeta = 3.288
c = 0.076
e = 0.99
k_n_per_rad = 49776.0
"""

# Seven specimens, too few for any claim.
EXPERIMENTS = """specimen,p_max_pa,p_max_sd_pa,mu,mu_sd
a,8.0e6,3e5,0.0048,0.0002
b,9.0e6,3e5,0.0046,0.0002
c,10.0e6,3e5,0.0045,0.0002
d,11.0e6,3e5,0.0043,0.0002
e,12.0e6,3e5,0.0045,0.0002
f,13.0e6,3e5,0.0042,0.0002
g,14.0e6,3e5,0.0046,0.0002
"""


# Density of dry air at 0 C and 101325 Pa [kg/m3].
AIR = 101325 / (287.05 * 273.15)


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(MODEL)
    return path


@pytest.fixture
def runs(tmp_path):
    """Two straight glides: mu g and drag slow the sled, so the losses of driving are nothing."""
    t = np.arange(0.0, 6.0, 0.01)
    header = "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa"
    rows = []
    for name, v0 in (("one", 25.0), ("two", 30.0)):
        v = np.empty_like(t)
        v[0] = v0
        for k in range(1, t.size):
            drag = 0.5 * AIR * 0.28 * v[k - 1] ** 2 / 390.0
            v[k] = v[k - 1] - 0.01 * (0.004 * 9.81 + drag)
        ax = -(0.004 * 9.81 + 0.5 * AIR * 0.28 * v**2 / 390.0)
        columns = "t_s,ax_mps2,ay_mps2,az_mps2,roll_rate_radps,pitch_rate_radps,yaw_rate_radps,v_mps,alpha_rad,delta_rad,gamma_rad"
        table = np.zeros((t.size, 11))
        table[:, 0], table[:, 1], table[:, 3], table[:, 7] = t, ax, 9.81, v
        np.savetxt(tmp_path / f"{name}.csv", table, delimiter=",", header=columns, comments="")
        rows.append(f"{name},{name}.csv,Test,Driver,pro,s1,-5,0,101325")
    path = tmp_path / "runs.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_a_straight_glide_loses_nothing_by_driving(runs, model):
    evaluation = kufe.evaluate(runs, model)
    assert [run["run"] for run in evaluation.runs] == ["one", "two"]
    for run in evaluation.runs:
        assert abs(run["increase_total"]) < 1e-6
        t, v0 = run["time_s"], {"one": 25.0, "two": 30.0}[run["run"]]
        # mu g + k v^2 = -dv/dt has a closed form: v = c tan(atan(v0/c) - c k t), c^2 = mu g/k.
        k = 0.5 * AIR * 0.28 / 390.0
        c = (0.004 * 9.81 / k) ** 0.5
        v1 = c * np.tan(np.arctan(v0 / c) - c * k * t)
        assert run["e_tot_loss_j"] == pytest.approx(0.5 * 390.0 * (v1**2 - v0**2), rel=0.01)
    assert evaluation.groups and evaluation.left_out == []
    series = evaluation.series("two")
    assert series["t_s"].shape == series["actual_n"].shape
    assert np.allclose(series["actual_n"], series["ideal_n"])
    assert "2 runs" in repr(evaluation)


def test_runs_can_be_chosen_and_bad_ones_named(runs, model):
    with pytest.raises(kufe.InputError, match="s9"):
        kufe.evaluate(runs, model, session=["s9"])
    with pytest.raises(kufe.InputError, match="the runs are one, two"):
        kufe.evaluate(runs, model).series("three")
    with pytest.raises(kufe.InputError, match="cutoff"):
        kufe.evaluate(runs, model, cutoff_hz=0.0)
    (runs.parent / "two.csv").write_text("t_s,v_mps\n0,nan\n")
    with pytest.raises(kufe.InputError, match="two.csv"):
        kufe.evaluate(runs, model)
    one = kufe.evaluate(runs, model, leave_out_bad_runs=True)
    assert len(one.runs) == 1 and "two.csv" in one.left_out[0]


def test_seven_specimens_name_nothing(tmp_path, model):
    data = tmp_path / "experiments.csv"
    data.write_text(EXPERIMENTS)
    found = kufe.discover(data, model, twins=10)
    assert found.verdict in ("none", "not-identifiable")
    assert found.report["verdict"] == found.verdict
    assert json.dumps(found.report) and found.sentence in found.html
    assert "[friction.longitudinal]" in found.next_model


def test_the_second_block_of_the_documentation_runs(runs, model, monkeypatch):
    monkeypatch.chdir(runs.parent)
    (runs.parent / "experiments.csv").write_text(EXPERIMENTS)
    text = pathlib.Path(os.environ["KUFE_PAGE"]).read_text()
    block = text.split("```python\n")[2].split("```")[0]
    names = {"kufe": kufe}
    exec(compile(block, "python.md", "exec"), names)
    assert len(names["evaluation"].groups) > 0 and names["found"].sentence


def test_wrong_data_is_told(tmp_path, model):
    with pytest.raises(kufe.InputError, match="twins 3"):
        kufe.discover("data.csv", model, twins=3)
    with pytest.raises(kufe.InputError, match="all, lateral or longitudinal"):
        kufe.discover("data.csv", model, channels="up")
    data = tmp_path / "data.csv"
    data.write_text("a,b\n1,2\n")
    with pytest.raises(kufe.InputError, match="data.csv"):
        kufe.discover(data, model)
