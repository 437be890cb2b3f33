"""Cases and their solutions."""

import copy
import json
import multiprocessing
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import kufe
from test_runs import MODEL

PARABOLOID = """
[runner]
shape = { kind = "paraboloid", rocker_radius_m = 30.0, section_radius_m = 0.005 }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = "half-space"
[load]
fz_n = 1000.0
[accuracy]
p_max = 0.005
"""

# Hertz for these radii, E/(1 - nu^2) and load: the peak that the Rust documentation states.
HERTZ_PA = 138.52e6


def test_the_peak_is_hertz_within_the_requested_accuracy():
    contact = kufe.press(kufe.Case(PARABOLOID))
    assert contact.p_max_pa == pytest.approx(HERTZ_PA, rel=0.005)
    assert 0 < contact.p_max_error_pa < 0.005 * contact.p_max_pa
    for key in ("p_mean_pa", "area_m2", "length_m", "width_m", "approach_m"):
        name, unit = key.rsplit("_", 1)
        error = getattr(contact, f"{name}_error_{unit}")
        assert error == contact.result[f"{name}_error_{unit}"]
        assert 0 < error < 0.1 * getattr(contact, key)


def test_the_largest_shear_under_the_peak_is_hertzs_within_its_error():
    case = kufe.Case(PARABOLOID)
    assert kufe.press(case).max_shear_pa is None
    contact = kufe.press(case, subsurface=True)
    # Of a line contact, as good as this one (K. L. Johnson, Contact Mechanics, section 4.1).
    error = contact.max_shear_error_pa
    assert abs(contact.max_shear_pa - 0.300 * HERTZ_PA) < error < 0.03 * contact.max_shear_pa
    depth, error = contact.max_shear_depth_m, contact.max_shear_depth_error_m
    half = 0.5 * contact.width_m
    assert abs(depth - 0.786 * half) < error + 0.4 * contact.width_error_m
    assert contact.result["subsurface"]["max_shear_error_pa"] == contact.max_shear_error_pa


def test_the_pressure_field_carries_the_load():
    contact = kufe.press(kufe.Case(PARABOLOID))
    pressure = contact.pressure_pa
    assert pressure.shape == (contact.y_m.size, contact.x_m.size)
    assert pressure.dtype == np.float64 and (pressure >= 0).all()
    load = np.trapezoid(np.trapezoid(pressure, contact.x_m, axis=1), contact.y_m)
    # The trapezoidal rule spreads the patch's edge over one cell, where the solver resolves it below the cell.
    assert load == pytest.approx(1000.0, rel=0.02)
    assert contact.fz_n == pytest.approx(1000.0, rel=1e-9)
    touching = pressure > 0
    assert (contact.gap_m[touching] < 1e-9).all()
    assert (contact.gap_m[~touching] > -1e-12).all()
    assert contact.uz_m.min() < 0


def test_the_map_carries_the_load_on_an_even_grid():
    contact = kufe.press(kufe.Case(PARABOLOID), accuracy=0.05)
    found = contact.map()
    x, y, pressure = found["x_m"], found["y_m"], found["pressure_pa"]
    assert pressure.shape == found["gap_m"].shape == found["uz_m"].shape == (y.size, x.size)
    assert np.ptp(np.diff(x)) < 1e-12 and np.ptp(np.diff(y)) < 1e-12
    assert pressure.sum() * (x[1] - x[0]) * (y[1] - y[0]) == pytest.approx(contact.fz_n, rel=1e-9)


def test_pressure_grows_with_the_cube_root_of_the_load():
    case = kufe.Case(PARABOLOID)
    one = kufe.press(case)
    eight = kufe.press(case.replace({"load.fz_n": 8000}))
    assert eight.p_max_pa / one.p_max_pa == pytest.approx(2.0, rel=0.01)
    assert case.to_toml() != case.replace({"load.fz_n": 8000}).to_toml()


def test_the_result_is_the_commands():
    contact = kufe.press(kufe.Case.example(), accuracy=0.02)
    result = contact.result
    assert result["p_max_pa"] == contact.p_max_pa
    assert result["case"]["accuracy"]["p_max"] == 0.02
    assert result["case"]["track"]["radius_m"] == "inf"
    assert any("yields at 10 to 30 MPa" in warning for warning in contact.warnings)
    assert "p_max" in repr(contact)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"ice.poissons_ratio": 0.5}, "ice.poissons_ratio"),
        ({"ice.poison": 0.3}, "poison"),
        ({"load.fz_n": "much"}, "fz_n"),
        ({"load.fz_n.deeper": 1.0}, "expected a table"),
        ({"load.fz_n": [1.0]}, "expected a number"),
    ],
)
def test_a_wrong_value_is_named(change, text):
    with pytest.raises(kufe.InputError, match=text):
        kufe.Case(PARABOLOID).replace(change)


def test_values_are_replaced_by_what_numpy_and_results_have():
    case = kufe.Case.example()
    for load in (2000, np.int64(2000), np.float32(2000), np.array(2000.0)):
        assert case.replace({"load.fz_n": load}).to_toml() == case.replace({"load.fz_n": 2000.0}).to_toml()
    elastic = case.replace({"runner.elastic": True}).to_toml()
    assert case.replace({"runner.elastic": np.True_}).to_toml() == elastic != case.to_toml()
    bent = case.replace({"track.radius_m": 40.0})
    found = kufe.press(case, accuracy=0.1).result["case"]["track"]["radius_m"]
    assert bent.replace({"track.radius_m": found}).to_toml() == case.to_toml()
    curved = bent.replace({"track.radius_m": None, "track.curvature_1pm": 0.025, "sliding.v_mps": None})
    assert "radius_m = 40" not in curved.to_toml() and "curvature_1pm" in curved.to_toml()
    with pytest.raises(kufe.InputError, match="found dict, expected a number"):
        case.replace({"load": {"fz_n": 1.0}})


def test_a_missing_file_and_a_bad_case_are_named(tmp_path):
    with pytest.raises(kufe.InputError, match="nowhere.toml: cannot be read"):
        kufe.press("nowhere.toml")
    bad = tmp_path / "bad.toml"
    bad.write_text(PARABOLOID.replace("fz_n = 1000.0", "fz_n = -1.0"))
    with pytest.raises(kufe.InputError, match=r"bad.toml: line 9: load.fz_n = -1"):
        kufe.press(bad)
    assert issubclass(kufe.InputError, kufe.Error) and issubclass(kufe.InputError, ValueError)
    assert pickle.loads(pickle.dumps(kufe.InputError("text"))).args == ("text",)


def test_an_accuracy_out_of_reach_is_another_exception(monkeypatch):
    case = kufe.Case(PARABOLOID)
    with pytest.raises(kufe.InputError, match="accuracy.p_max"):
        kufe.press(case, accuracy=0.0)
    assert not issubclass(kufe.NotConvergedError, kufe.InputError)


def test_progress_is_reported_and_may_stop_the_work():
    lines = []
    kufe.press(kufe.Case(PARABOLOID), progress=lines.append)
    assert all(line.startswith("mesh ") for line in lines)
    assert any("p_max" in line for line in lines)

    def stop(_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        kufe.press(kufe.Case(PARABOLOID), progress=stop)


def test_other_threads_run_while_a_case_is_solved():
    done = threading.Event()
    steps = 0

    def count():
        nonlocal steps
        while not done.is_set():
            steps += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    before = steps
    kufe.press(kufe.Case(PARABOLOID), accuracy=0.0005)
    during = steps - before
    done.set()
    counter.join()
    assert during > 3


def peak(load):
    return kufe.press(kufe.Case(PARABOLOID).replace({"load.fz_n": load}), accuracy=0.05).p_max_pa


@pytest.mark.skipif(sys.platform != "linux", reason="workers are forked on Linux")
def test_forked_workers_solve_too():
    loads = [500.0, 1000.0]
    expected = [peak(load) for load in loads]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(peak, loads).get(timeout=60) == expected


def test_a_sliding_runner_has_its_groove_and_its_friction():
    case = kufe.Case(PARABOLOID).replace({"load.tilt": "fixed", "load.fz_n": 950.0})
    slid = kufe.slide(case, 20.0, -5.0, accuracy=0.03)
    result = slid.result
    assert result["hardness_pa"] == pytest.approx(17.7e6)
    assert result["mu"] == pytest.approx(result["mu_ploughing"] + result["mu_viscous"])
    groove = slid.groove_m
    assert groove.shape == slid.pressure_pa.shape
    assert groove.max() == pytest.approx(result["groove_depth_m"])
    # It never falls towards the back, which is where x is least.
    assert (np.diff(groove, axis=1) <= 1e-15).all()
    # The plastic work over the way is the ploughing force: hardness times the section of the groove.
    work = slid.result["hardness_pa"] * np.trapezoid(groove[:, 0], slid.y_m)
    assert work / 950.0 == pytest.approx(result["mu_ploughing"], rel=0.03)
    rough = case.replace({"sliding.v_mps": 20.0, "sliding.ice_c": -5.0, "sliding.roughness_m": 0.5e-6, "sliding.boundary_shear_pa": 60e3})
    rough = kufe.slide(rough, 20.0, -5.0, accuracy=0.03).result
    parts = rough["mu_ploughing"] + rough["mu_viscous"] + rough["mu_boundary"]
    assert rough["mu"] == pytest.approx(parts) and rough["mu_boundary"] > 0.0 == result["mu_boundary"]
    assert 0.0 < rough["boundary_share"] < 1.0
    assert kufe.press(case).groove_m is None
    with pytest.raises(kufe.InputError, match="ice_c"):
        kufe.slide(case, 20.0, 1.0)


def test_a_contact_is_written_as_the_command_writes_it(tmp_path):
    contact = kufe.press(kufe.Case(PARABOLOID), accuracy=0.05)
    contact.write(tmp_path / "new" / "out", mat=True)
    names = {path.name for path in (tmp_path / "new" / "out").iterdir()}
    assert names == {"result.json", "result.mat", "pressure.exr", "pressure.png", "field.vtu", "contact.vtp"}
    written = json.loads((tmp_path / "new" / "out" / "result.json").read_text())
    assert written["p_max_pa"] == contact.p_max_pa
    assert written["p_max_map_pa"] == pytest.approx(contact.pressure_pa.max(), rel=0.01)
    with pytest.raises(kufe.InputError, match="not empty"):
        contact.write(tmp_path / "new" / "out")
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["out"]


def test_a_contact_is_pickled_without_its_meshes(tmp_path):
    solved = kufe.press(kufe.Case(PARABOLOID), accuracy=0.05, subsurface=True)
    case = kufe.Case(PARABOLOID).replace({"load.tilt": "fixed", "load.fz_n": 950.0})
    for contact in (solved, kufe.slide(case, 20.0, -5.0, accuracy=0.05)):
        again = pickle.loads(pickle.dumps(contact))
        for name in vars(kufe.Contact):
            value = getattr(contact, name)
            if not name.startswith("_") and not callable(value):
                np.testing.assert_equal(getattr(again, name), value)
        assert repr(again) == repr(contact)
        with pytest.raises(kufe.InputError, match="has no meshes"):
            again.write(tmp_path / "out")
        with pytest.raises(kufe.InputError, match="has no meshes"):
            again.map()
    assert not (tmp_path / "out").exists()
    copy.deepcopy(solved).write(tmp_path / "out")


def test_a_contact_is_shown_and_tabled():
    contact = kufe.press(kufe.Case(PARABOLOID), accuracy=0.05)
    axes = contact.plot()
    shown = axes.collections[0].get_array()
    assert np.nanmax(shown) == pytest.approx(1e-6 * contact.pressure_pa.max())
    assert f"{contact.p_max_pa / 1e6:.5g}" in contact._repr_html_()
    pandas = pytest.importorskip("pandas")
    frame = contact.to_dataframe()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == contact.pressure_pa.size
    highest = frame.loc[frame.pressure_pa.idxmax()]
    j, i = np.unravel_index(contact.pressure_pa.argmax(), contact.pressure_pa.shape)
    assert (highest.x_m, highest.y_m) == (contact.x_m[i], contact.y_m[j])


def test_a_contact_becomes_a_dataset():
    pytest.importorskip("xarray")
    contact = kufe.press(kufe.Case(PARABOLOID), accuracy=0.05)
    data = contact.to_xarray()
    assert data.pressure_pa.dims == ("y_m", "x_m") and data.pressure_pa.units == "Pa"
    assert data.attrs["p_max_error_pa"] == contact.p_max_error_pa


def test_the_best_solution_comes_with_the_error():
    # Its rounded ends and its bed cost more than the paraboloid: the mesh's limit comes first.
    case = kufe.Case.example()
    with pytest.raises(kufe.NotConvergedError, match="requested 0.0100 %") as caught:
        kufe.press(case, accuracy=1e-4)
    best = caught.value.best
    assert best.p_max_pa == pytest.approx(138.7e6, rel=0.002)
    assert 1e-4 * best.p_max_pa < best.p_max_error_pa < 1e-3 * best.p_max_pa
    assert kufe.NotConvergedError("text").best is None


@pytest.mark.parametrize("work", ["press", "slide", "discover", "hull", "simulate"])
def test_ctrl_c_ends_within_two_seconds(work, tmp_path):
    jobs = {
        "press": "kufe.press(kufe.Case.example(), accuracy=1e-4)",
        "slide": "kufe.slide(kufe.Case.example(), 20.0, -5.0, accuracy=0.001)",
        "discover": "kufe.discover('experiments.csv', 'model.toml', twins=1000)",
        "hull": "kufe.Hull.bob(edge_length_m=6e-5)",
        "simulate": "kufe.simulate('model.toml', 'track_test.csv', runs=10_000)",
    }
    if work == "simulate":
        from test_runs import TRACK

        (tmp_path / "model.toml").write_text(MODEL)
        (tmp_path / "track_test.csv").write_text(TRACK)
    if work == "discover":
        rng = np.random.default_rng(1)
        pressures = enumerate(rng.uniform(5e7, 1e8, 20_000))
        rows = [f"s{k},{p:.9e},1e5,{4e-3 + 1e-4 * rng.normal():.9f},1e-4" for k, p in pressures]
        header = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd"
        (tmp_path / "experiments.csv").write_text("\n".join([header, *rows]))
        (tmp_path / "model.toml").write_text(MODEL)
    # A shell without job control starts programs that ignore the signal.
    handler = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    code = f"import kufe, signal\n{handler}\nprint('begun', flush=True)\ntry:\n    {jobs[work]}\nexcept KeyboardInterrupt:\n    print('interrupted', flush=True)\n"
    process = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.5)
    since = time.monotonic()
    process.send_signal(signal.SIGINT)
    printed, _ = process.communicate(timeout=60)
    assert printed == "interrupted\n"
    assert time.monotonic() - since < 2.0
