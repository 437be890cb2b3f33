"""Lookup tables."""

import errno
import os
import pathlib
import pickle
import re

import numpy as np
import pytest

import kufe
from test_contact import PARABOLOID

TABLE = """
case = "case.toml"
[axes]
fz_n = { values = [500.0, 1000.0, 2000.0] }
curvature_1pm = { values = [0.0, 0.02] }
"""


@pytest.fixture(scope="module")
def table_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("table")
    (folder / "case.toml").write_text(PARABOLOID)
    (folder / "table.toml").write_text(TABLE)
    return folder / "table.toml"


@pytest.fixture(scope="module")
def table(table_file):
    lines = []
    table = kufe.fill_table(table_file, progress=lines.append)
    # Six nodes, and the checks between them.
    assert re.fullmatch(r"round 1: (\d+) of \1 points", lines[-1])
    return table


def test_nodes_are_single_solves(table):
    case = kufe.Case(PARABOLOID).replace({"load.fz_n": 2000.0, "track.curvature_1pm": 0.02})
    assert table.values().shape == (3, 2)
    assert table.values()[2, 1] == kufe.press(case).p_max_pa
    assert table.shortfall is None
    assert 0 < table.solver_error <= 0.005
    assert 0 < table.interpolation_error() < table.interpolation_error(mode="bilinear") < 0.1


def test_lookups_broadcast_and_say_where_they_are_outside(table):
    values, _, outside = table.lookup(np.array([[500.0], [1000.0], [9000.0]]), [0.0, 0.02])
    assert values.shape == outside.shape == (3, 2)
    assert np.array_equal(values[:2], table.values()[:2])
    assert outside.tolist() == [[False, False], [False, False], [True, True]]
    scalar, _, flag = table.lookup(1000.0, 0.0, "area")
    assert scalar.shape == () and not flag
    assert float(scalar) == table.values("area")[1, 0]
    nan, error, flag = table.lookup(float("nan"), 0.0)
    assert np.isnan(nan) and np.isnan(error) and flag


def test_lookups_have_the_errors_of_interpolation_and_solver(table):
    for mode in ("smooth", "bilinear"):
        values, errors, _ = table.lookup([700.0, 1500.0], 0.01, mode=mode)
        relative = table.solver_error + table.interpolation_error(mode=mode)
        assert errors == pytest.approx(relative * values, rel=1e-12)


def test_a_case_replaces_that_of_the_table_file(table, tmp_path):
    wanted = tmp_path / "table.toml"
    wanted.write_text(TABLE.replace("case.toml", "none.toml"))
    replaced = kufe.fill_table(wanted, case=kufe.Case(PARABOLOID))
    assert np.array_equal(replaced.values(), table.values())


def test_the_smooth_mode_keeps_the_power_law(table):
    middle = np.sqrt(500.0 * 1000.0)
    smooth, _, _ = table.lookup(middle, 0.0)
    plain, _, _ = table.lookup(middle, 0.0, mode="bilinear")
    exact = table.values()[0, 0] * (middle / 500.0) ** (1 / 3)
    assert abs(smooth / exact - 1) < 0.003 < abs(plain / exact - 1)


def test_a_written_table_is_read_again(table, table_file, tmp_path):
    again = kufe.Table.read(table_file.with_suffix(".lut"))
    assert np.array_equal(again.values("approach"), table.values("approach"))
    again.write(tmp_path / "copy.lut")
    assert (tmp_path / "copy.lut").read_bytes() == table_file.with_suffix(".lut").read_bytes()
    assert list(again.fz_n) == [500.0, 1000.0, 2000.0]
    assert list(again.curvature_1pm) == [0.0, 0.02] and again.rocker_radius_m is None
    assert not table_file.with_suffix(".lut.points").exists()


def test_bad_tables_and_names_are_refused(table, tmp_path):
    broken = tmp_path / "broken.lut"
    broken.write_text("{}")
    with pytest.raises(kufe.InputError, match="broken.lut"):
        kufe.Table.read(broken)
    with pytest.raises(FileNotFoundError, match="none.lut") as missing:
        kufe.Table.read(tmp_path / "none.lut")
    assert isinstance(missing.value, kufe.InputError) and missing.value.errno == errno.ENOENT
    with pytest.raises(FileNotFoundError, match="none.toml"):
        kufe.Case.read(tmp_path / "none.toml")
    with pytest.raises(OSError, match="cannot be written"):
        table.write(tmp_path / "broken.lut" / "table.lut")
    with pytest.raises(kufe.InputError, match="p_max, p_mean"):
        table.lookup(1.0, 0.0, "pmax")
    with pytest.raises(kufe.InputError, match="smooth or bilinear"):
        table.lookup(1.0, 0.0, mode="cubic")
    for key in ("rocker_radius_m", "v_mps", "ice_c"):
        with pytest.raises(kufe.InputError, match=key.split("_")[0]):
            table.lookup(1.0, 0.0, **{key: 30.0})


def test_an_exception_of_the_progress_keeps_the_points_done(table_file, tmp_path):
    (tmp_path / "case.toml").write_text(PARABOLOID)
    wanted = tmp_path / "table.toml"
    wanted.write_text(TABLE)

    def stop_after_two(line):
        if "2 of" in line:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        kufe.fill_table(wanted, progress=stop_after_two)
    assert not (tmp_path / "table.lut").exists()
    assert (tmp_path / "table.lut.points").read_text().count("\n") >= 2
    kufe.fill_table(wanted)
    assert (tmp_path / "table.lut").read_bytes() == table_file.with_suffix(".lut").read_bytes()


def test_a_table_that_slides_is_what_slide_says(tmp_path):
    case = PARABOLOID.replace("p_max = 0.005", "p_max = 0.05").replace("[load]", '[load]\ntilt = "fixed"')
    case += "[sliding]\nv_mps = 20.0\nice_c = -5.0\n"
    (tmp_path / "case.toml").write_text(case)
    wanted = tmp_path / "table.toml"
    axes = "fz_n = { values = [600.0, 1000.0] }\ncurvature_1pm = { values = [0.0] }\n"
    axes += "v_mps = { values = [6.0, 25.0] }\nice_c = { values = [-9.0, -4.0] }\n"
    wanted.write_text(f'case = "case.toml"\n[axes]\n{axes}[accuracy]\nchecks = 0\n')
    table = kufe.fill_table(wanted)
    assert table.values("mu").shape == (2, 1, 2, 2)
    assert table.v_mps.tolist() == [6.0, 25.0] and table.ice_c.tolist() == [-9.0, -4.0]
    slid = kufe.slide(kufe.Case(case), v_mps=25.0, ice_c=-4.0)
    assert table.values("mu")[1, 0, 1, 1] == pytest.approx(slid.result["mu"], rel=1e-9)
    mu, _, outside = table.lookup(1000.0, 0.0, "mu", v_mps=[6.0, 25.0, 30.0], ice_c=-4.0)
    assert np.array_equal(mu[:2], table.values("mu")[1, 0, :, 1])
    assert outside.tolist() == [False, False, True]
    with pytest.raises(kufe.InputError, match="v_mps"):
        table.lookup(1000.0, 0.0, "mu", ice_c=-4.0)


def test_a_table_is_pickled_and_tabled(table):
    again = pickle.loads(pickle.dumps(table))
    assert again.quantities == table.quantities
    for quantity in table.quantities:
        assert (again.values(quantity) == table.values(quantity)).all()
    pytest.importorskip("pandas")
    frame = table.to_dataframe()
    row = frame.iloc[-1]
    assert (row.fz_n, row.curvature_1pm) == (table.fz_n[-1], table.curvature_1pm[-1])
    assert row.p_max == table.values("p_max")[-1, -1]


def test_nodes_of_reduced_curvatures_are_at_their_track_curvatures():
    table = kufe.Table.read(pathlib.Path(os.environ["KUFE_PAGE"]).parent.parent / "assets/tables/front.lut")
    reduced, curvature = table.reduced_curvature, table.curvature_1pm
    assert (reduced[0], reduced[-1]) == (0.0, 1.0)
    assert curvature.shape == table.values().shape
    # The ends do not depend on the force, the middle does.
    assert np.ptp(curvature[:, [0, -1]], axis=0).tolist() == [0.0, 0.0]
    assert np.ptp(curvature[:, 1:-1], axis=0).min() > 1e-6
    found, _, outside = table.lookup(table.fz_n[:, None], curvature)
    np.testing.assert_allclose(found, table.values(), rtol=1e-9)
    assert not outside.any()
    pandas = pytest.importorskip("pandas")
    frame = table.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    found, _, _ = table.lookup(frame.fz_n, frame.curvature_1pm)
    np.testing.assert_allclose(found, frame.p_max, rtol=1e-9)
    assert frame.reduced_curvature.max() == 1.0
    pytest.importorskip("xarray")
    array = table.to_xarray()
    assert array.dims == ("fz_n", "reduced_curvature")
    assert (array.curvature_1pm.values == curvature).all()


def test_masked_inputs_are_nan(table):
    forces = np.ma.masked_array([500.0, 1000.0, 2000.0], mask=[False, True, False])
    values, _, outside = table.lookup(forces, 0.0)
    assert values[[0, 2]].tolist() == table.values()[[0, 2], 0].tolist()
    assert np.isnan(values[1]) and outside.tolist() == [False, True, False]


def test_rocker_radii_broadcast(tmp_path):
    (tmp_path / "case.toml").write_text(PARABOLOID.replace("p_max = 0.005", "p_max = 0.05"))
    axes = "rocker_radius_m = { values = [20.0, 40.0] }\n"
    (tmp_path / "table.toml").write_text(TABLE + axes + "[accuracy]\nchecks = 0\n")
    table = kufe.fill_table(tmp_path / "table.toml")
    radii = np.array([[40.0], [20.0], [30.0]])
    values, _, outside = table.lookup([500.0, 1000.0], 0.0, rocker_radius_m=radii)
    assert values.shape == (3, 2) and not outside.any()
    assert np.array_equal(values[:2], table.values()[:2, 0, ::-1].T)
    assert (values[2] == table.lookup([500.0, 1000.0], 0.0, rocker_radius_m=30.0)[0]).all()
    with pytest.raises(kufe.InputError, match="50"):
        table.lookup(500.0, 0.0, rocker_radius_m=[30.0, 50.0])
