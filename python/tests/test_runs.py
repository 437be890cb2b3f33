"""Evaluation and discovery."""

import json
import os
import pathlib
import shutil

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
    assert [row["driver"] for row in evaluation.drivers] == ["Driver"]
    assert evaluation.result["drivers"] == evaluation.drivers
    series = evaluation.series("two")
    assert series["t_s"].shape == series["actual_n"].shape
    assert np.allclose(series["actual_n"], series["ideal_n"])
    assert "2 runs" in repr(evaluation)


def test_runs_can_be_chosen_and_bad_ones_named(runs, model):
    with pytest.raises(kufe.InputError, match="s9"):
        kufe.evaluate(runs, model, session=["s9"])
    assert len(kufe.evaluate(runs, model, session="s1").runs) == 2
    with pytest.raises(kufe.InputError, match="seed = -1: expected 0 to"):
        kufe.evaluate(runs, model, seed=-1)
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


def track_of_three_curves():
    """Left, right, left: the sled is pressed onto the bank of each."""
    s = np.arange(0.0, 701.0)
    curvature, bank = np.zeros_like(s), np.zeros_like(s)
    for start, side in ((80.0, 1.0), (280.0, -1.0), (480.0, 1.0)):
        inside = (s >= start) & (s <= start + 120.0)
        shape = np.sin(np.pi * (s[inside] - start) / 120.0) ** 2
        curvature[inside], bank[inside] = 0.018 * shape, 0.9 * side * shape
    rows = (f"{place:.0f},0.1,{c:.9f},{b:.9f}" for place, c, b in zip(s, curvature, bank))
    return "\n".join(["s_m,slope_rad,curvature_1pm,bank_rad", *rows]) + "\n"


TRACK = track_of_three_curves()


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    folder = tmp_path_factory.mktemp("driven")
    (folder / "model.toml").write_text(MODEL)
    (folder / "track_test.csv").write_text(TRACK)
    driven = kufe.simulate(folder / "model.toml", folder / "track_test.csv", runs=3, ice_c=-5.0, seed=3)
    driven.write(folder / "runs")
    return folder, driven


def test_simulated_runs_keep_their_energy_and_are_written(driven):
    folder, driven = driven
    assert [run["run"] for run in driven.runs] == ["run_001", "run_002", "run_003"]
    for run in driven.runs:
        assert run["finished"] and run["energy_balance_relative_error"] < 1e-4
    series = driven.series("run_002")
    assert series["t_s"][-1] - series["t_s"][0] == pytest.approx(driven.runs[1]["time_s"])
    assert series["v_mps"].shape == series["t_s"].shape and series["s_m"][-1] > 690.0
    # The channels are those of the written file, which rounds them.
    written = np.genfromtxt(folder / "runs" / "run_002.csv", delimiter=",", names=True)
    assert np.allclose(written["v_mps"], series["v_mps"], rtol=1e-6)
    names = {path.name for path in (folder / "runs").iterdir()}
    assert names == {"runs.csv", "run_001.csv", "run_002.csv", "run_003.csv", "track_test.csv"}
    assert driven.result["track"] == "test" and "3 runs on test" in repr(driven)


def test_wrong_simulations_are_named(driven):
    folder, driven = driven
    model, track = folder / "model.toml", folder / "track_test.csv"
    with pytest.raises(kufe.InputError, match="runs = 0: expected 1 to 10000"):
        kufe.simulate(model, track, runs=0)
    with pytest.raises(kufe.InputError, match="runs = -1: expected 1 to 10000"):
        kufe.simulate(model, track, runs=-1)
    with pytest.raises(kufe.InputError, match="seed = -1: expected 0 to"):
        kufe.simulate(model, track, seed=np.int64(-1))
    with pytest.raises(kufe.InputError, match="driver Z9: expected one of A1"):
        kufe.simulate(model, track, driver="Z9")
    with pytest.raises(kufe.InputError, match="ice-c 20"):
        kufe.simulate(model, track, ice_c=20.0)
    with pytest.raises(kufe.InputError, match="the runs are run_001"):
        driven.series("none")
    with pytest.raises(kufe.InputError, match="not empty"):
        driven.write(folder / "runs")


def test_a_run_is_driven_again(driven, tmp_path):
    folder, _ = driven
    files = (folder / "model.toml", folder / "track_test.csv", folder / "runs" / "runs.csv")
    again = kufe.replay(*files, run="run_002")
    # The same model drove both: digits of the file remain.
    difference = {row["column"]: row["rms"] for row in again.differences}
    assert difference["v_mps"] < 1e-3 and difference["yaw_rate_radps"] < 1e-3
    series = again.series()
    measured = series["v_measured_mps"]
    there = np.isfinite(measured)
    assert there.mean() > 0.99 and np.allclose(series["v_mps"][there], measured[there], atol=1e-3)
    assert again.result["replay"]["run"] == "run_002" and again.result["finished"]
    assert again.result["replay"]["sections"] == again.sections and "run_002 on test" in repr(again)
    again.write(tmp_path / "again")
    names = {path.name for path in (tmp_path / "again").iterdir()}
    assert names == {"runs.csv", "run_002.csv", "track_test.csv"}
    with pytest.raises(kufe.InputError, match="run_9: the runs are run_001, run_002, run_003"):
        kufe.replay(*files, run="run_9")


def test_noise_that_the_runs_do_not_have_is_reported_by_a_fit(driven):
    folder, _ = driven
    model = folder / "noisy.toml"
    model.write_text(MODEL + "[noise]\nslip_rad = 0.0005\n")
    remarks = kufe.fit(folder / "runs" / "runs.csv", model).remarks
    assert any("omit [noise]" in remark for remark in remarks)


def test_a_fit_finds_the_grip_that_runs_were_driven_with_and_validates_the_others(driven):
    folder, _ = driven
    index, model = folder / "runs" / "runs.csv", folder / "model.toml"
    fit = kufe.fit(index, model)
    for runner, given in ((fit.front, 10522.0), (fit.rear, 49776.0)):
        k = runner["k_n_per_rad"]
        assert k["low"] < k["value"] < k["high"]
        assert k["value"] == pytest.approx(given, rel=0.05)
    assert fit.result["runs"] == ["run_001", "run_002", "run_003"] and "3 runs" in repr(fit)
    (folder / "fitted.toml").write_text(fit.model)
    of_model = kufe.validate(index, model)
    of_fit = kufe.validate(index, folder / "fitted.toml")
    assert [run["run"] for run in of_fit.runs] == fit.result["runs"]
    assert of_fit.tracks[0]["rmse_n"] == pytest.approx(of_model.tracks[0]["rmse_n"], rel=0.2)
    series = of_model.series("run_003")
    difference = series["measured_n"] - series["model_n"]
    rmse = np.sqrt(np.mean(difference**2))
    assert rmse == pytest.approx(of_model.runs[2]["rmse_n"], rel=1e-6)
    # The fit used every run: none remains to validate it.
    with pytest.raises(kufe.InputError, match="fitted to all 3"):
        kufe.validate(index, model, fit=fit)
    (folder / "fit.json").write_text(json.dumps(fit.result))
    with pytest.raises(kufe.InputError, match="fitted to all 3"):
        kufe.validate(index, model, fit=folder / "fit.json")
    with pytest.raises(kufe.InputError, match="expected what kufe fit lateral writes"):
        kufe.validate(index, model, fit=model)


MAPPING = """
[logger.box]
files = "raw/*.csv"
time = "Time"
[channels]
v_mps = { from = "Speed", unit = "km/h" }
ay_mps2 = { from = "Lateral", unit = "g", sign = -1 }
[index]
track = "test"
"""


def test_recordings_are_imported_in_their_units(tmp_path):
    (tmp_path / "raw").mkdir()
    t = np.arange(0.0, 5.0, 0.01)
    table = np.column_stack([t, 72.0 + 0.0 * t, 0.5 + 0.0 * t])
    np.savetxt(tmp_path / "raw" / "one.csv", table, delimiter=",", header="Time,Speed,Lateral", comments="", fmt="%.6f")
    (tmp_path / "raw" / "two.csv").write_text("Time,Speed\n0,1\n")
    (tmp_path / "mapping.toml").write_text(MAPPING)
    listed = kufe.import_runs(tmp_path / "mapping.toml", tmp_path / "runs")
    assert [run["run"] for run in listed["runs"]] == ["one"]
    assert [run["run"] for run in listed["excluded"]] == ["two"]
    run = np.genfromtxt(tmp_path / "runs" / "one.csv", delimiter=",", names=True)
    assert np.allclose(run["v_mps"][50:-50], 20.0) and np.allclose(run["ay_mps2"][50:-50], -0.5 * 9.80665)
    names = {path.name for path in (tmp_path / "runs").iterdir()}
    assert names == {"runs.csv", "one.csv", "one.import.json", "import.json"}
    with pytest.raises(kufe.InputError, match="two"):
        kufe.import_runs(tmp_path / "mapping.toml", tmp_path / "strict", strict=True)
    assert not (tmp_path / "strict").exists()


def test_the_third_block_of_the_documentation_runs(driven, tmp_path, monkeypatch):
    from test_contact import PARABOLOID

    folder, _ = driven
    shutil.copytree(folder / "runs", tmp_path, dirs_exist_ok=True)
    index = (tmp_path / "runs.csv").read_text().splitlines(keepends=True)
    assert index[3].startswith("run_003") and index[3].count(",1,") == 1
    (tmp_path / "runs.csv").write_text("".join([*index[:3], index[3].replace(",1,", ",2,")]))
    shutil.copy(folder / "model.toml", tmp_path)
    shutil.copy(folder / "track_test.csv", tmp_path / "track.csv")
    (tmp_path / "raw").mkdir()
    shutil.copy(folder / "runs" / "run_001.csv", tmp_path / "raw" / "one.csv")
    (tmp_path / "mapping.toml").write_text(MAPPING.replace("Time", "t_s").replace("Speed", "v_mps").replace("Lateral", "ay_mps2"))
    kufe.Hull.bob(edge_length_m=0.001).write(tmp_path / "scan.stl")
    case = kufe.Case(PARABOLOID).replace({"load.tilt": "fixed", "accuracy.p_max": 0.05})
    kufe.press(case).write(tmp_path / "out")
    monkeypatch.chdir(tmp_path)
    text = pathlib.Path(os.environ["KUFE_PAGE"]).read_text()
    block = text.split("```python\n")[3].split("```")[0]
    names = {"kufe": kufe, "case": case}
    exec(compile(block, "python.md", "exec"), names)
    assert [run["run"] for run in names["validation"].runs] == ["run_003"]
    assert (tmp_path / "driven" / "runs.csv").exists() and "</html>" in names["html"]


def test_a_page_is_that_of_the_folder(tmp_path):
    from test_contact import PARABOLOID

    kufe.press(kufe.Case(PARABOLOID), accuracy=0.05).write(tmp_path / "out")
    page = kufe.report(tmp_path / "out")
    assert page.startswith("<!DOCTYPE html>") and "p_max_pa" in page
    with pytest.raises(kufe.InputError, match="nothing"):
        kufe.report(tmp_path / "nothing")


def test_wrong_data_is_refused(tmp_path, model):
    with pytest.raises(kufe.InputError, match="twins 3"):
        kufe.discover("data.csv", model, twins=3)
    with pytest.raises(kufe.InputError, match="all, lateral or longitudinal"):
        kufe.discover("data.csv", model, channels="up")
    data = tmp_path / "data.csv"
    data.write_text("a,b\n1,2\n")
    with pytest.raises(kufe.InputError, match="data.csv"):
        kufe.discover(data, model)
