"""Hulls."""

import pickle

import numpy as np
import pytest

import kufe


def small(**changes):
    return kufe.Hull.bob(**{"length_m": 0.2, "edge_length_m": 0.004, **changes})


def test_a_runner_has_the_requested_size():
    hull = small(height_m=0.02)
    assert hull.vertices_m.shape[1] == 3 and hull.vertices_m.dtype == np.float64
    assert hull.triangles.shape[1] == 3 and hull.triangles.dtype == np.uint32
    assert hull.triangles.max() < len(hull.vertices_m)
    assert hull.extent_m == pytest.approx((0.2, 0.010, 0.02), rel=0.02)
    assert hull.warnings == []


def test_the_volume_is_that_of_the_triangles():
    hull = small()
    a, b, c = (hull.vertices_m[hull.triangles[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(hull.volume_m3, rel=1e-9)


@pytest.mark.parametrize("ending", ["obj", "glb", "stl"])
def test_a_written_hull_is_read_again(tmp_path, ending):
    hull = small()
    path = tmp_path / f"bob.{ending}"
    hull.write(path)
    up = {"up": "y"} if ending == "glb" else {}
    again = kufe.Hull.read(path, **up)
    assert again.triangles.shape == hull.triangles.shape
    # GLB and binary STL hold single precision.
    assert again.volume_m3 == pytest.approx(hull.volume_m3, rel=1e-4)


def test_a_luge_steel_is_a_hull():
    steel = kufe.Hull.luge(length_m=0.2, edge_length_m=0.004)
    assert steel.extent_m[0] == pytest.approx(0.2, rel=0.02)
    # Facets of its edge turn by at most 0.01 rad, as those of the command, from the flank to the flat.
    section = steel.vertices_m[np.abs(steel.vertices_m[:, 0]) < 1e-9]
    section = section[np.argsort(section[:, 1])]
    section = section[(-0.0002 < section[:, 1]) & (section[:, 1] < 0.0)]
    edge = np.arctan(np.diff(section[:, 2]) / np.diff(section[:, 1]))
    assert len(edge) > 20 and np.abs(np.diff(edge)).max() < 0.011


def test_bad_hulls_are_refused(tmp_path):
    with pytest.raises(kufe.InputError, match="section"):
        small(section_radius_m=-1.0)
    with pytest.raises(kufe.InputError, match="none.obj"):
        kufe.Hull.read(tmp_path / "none.obj")
    with pytest.raises(kufe.InputError, match="sideways"):
        kufe.Hull.read("bob.obj", forward="sideways")
    with pytest.raises(kufe.InputError, match="xyz"):
        small().write(tmp_path / "bob.xyz")


def paraboloid_heights():
    """A paraboloid of the radii 30 m and 5 mm, sampled over what it touches the ice with."""
    x, y = np.linspace(-0.06, 0.06, 121), np.linspace(-0.002, 0.002, 41)
    return x, y, x**2 / 60.0 + y[:, None] ** 2 / 0.01


# Hertz for these radii, E/(1 - nu^2) and 1000 N: the peak that the Rust documentation states.
HERTZ_PA = 138.52e6
HALF_SPACE = {"ice.thickness_m": "half-space", "ice.youngs_modulus_pa": 9e9, "ice.poissons_ratio": 0.33}


def test_a_height_map_presses_as_hertz_says():
    hull = kufe.Hull.from_heights(*paraboloid_heights())
    contact = kufe.press(kufe.Case.of(hull, {**HALF_SPACE, "load.fz_n": 1000.0}))
    assert contact.p_max_pa == pytest.approx(HERTZ_PA, rel=0.02)


def test_heights_are_of_any_kind_and_masked_ones_are_holes():
    x, y, z = paraboloid_heights()
    z = np.rint(1e6 * z) * 2.0**-20
    whole = kufe.Hull.from_heights(x, y, z).vertices_m
    for same in (z.astype("f4"), z.astype(">f8"), z.tolist(), np.asfortranarray(z)):
        assert np.array_equal(kufe.Hull.from_heights(x, y, same).vertices_m, whole)
    assert kufe.Hull.from_heights([0, 1], [0, 1], [[0, 0], [1, 0]]).extent_m == (1.0, 1.0, 1.0)
    missing = np.zeros(z.shape, bool)
    missing[18:23, 95:106] = True
    hole = kufe.Hull.from_heights(x, y, np.where(missing, np.nan, z)).vertices_m
    assert len(hole) == len(whole) - missing.sum()
    for same in (np.ma.masked_array(np.where(missing, -1.0, z), missing), np.where(missing, np.inf, z)):
        assert np.array_equal(kufe.Hull.from_heights(x, y, same).vertices_m, hole)


def test_arrays_of_another_hull_press_as_its_file_does(tmp_path):
    hull = kufe.Hull.bob(length_m=0.2, edge_length_m=0.0015)
    arrays = kufe.Hull(hull.vertices_m, hull.triangles)
    assert arrays.volume_m3 == hull.volume_m3
    hull.write(tmp_path / "bob.obj")
    of_array = kufe.Case.of(arrays, {"accuracy.p_max": 0.05})
    text = of_array.to_toml().replace("an array", "bob.obj")
    of_file = kufe.press(kufe.Case(text, tmp_path))
    assert kufe.press(of_array).p_max_pa == pytest.approx(of_file.p_max_pa, rel=1e-9)


def test_arrays_that_are_no_hull_are_refused():
    hull = small()
    with pytest.raises(kufe.InputError, match="vertices_m: .*rows of three"):
        kufe.Hull(hull.vertices_m[:, :2], hull.triangles)
    with pytest.raises(kufe.InputError, match="triangles: found the vertex -1"):
        kufe.Hull(hull.vertices_m, [[0, 1, -1]])
    with pytest.raises(kufe.InputError, match="triangles: found the vertex -1"):
        kufe.Hull(hull.vertices_m, np.ma.masked_equal(hull.triangles, 0))
    for kind in (float, bool):
        with pytest.raises(TypeError, match="expected integers"):
            kufe.Hull(hull.vertices_m, hull.triangles.astype(kind))
    for wrong in (np.nan, np.inf):
        vertices = hull.vertices_m
        vertices[7, 2] = wrong
        with pytest.raises(kufe.InputError, match="vertex 8 .* finite"):
            kufe.Hull(vertices, hull.triangles)
    with pytest.raises(kufe.InputError, match="vertex 8 .* finite"):
        kufe.Hull(np.ma.masked_invalid(vertices), hull.triangles)
    with pytest.raises(kufe.InputError, match="no triangles"):
        kufe.Hull(np.empty((0, 3)), np.empty((0, 3)))
    with pytest.raises(kufe.InputError, match="heights_m: expected measured heights"):
        kufe.Hull.from_heights([0.0, 1.0], [0.0, 1.0], np.full((2, 2), np.nan))
    with pytest.raises(kufe.InputError, match="heights_m: expected measured heights"):
        kufe.Hull.from_heights([], [], np.empty((0, 0)))
    with pytest.raises(kufe.InputError, match="x_m: expected numbers that increase"):
        kufe.Hull.from_heights([1.0, 0.0], [0.0, 1.0], np.zeros((2, 2)))
    with pytest.raises(kufe.InputError, match="heights_m"):
        kufe.Hull.from_heights([0.0, 1.0, 2.0], [0.0, 1.0], np.zeros((3, 2)))


def test_a_hull_and_its_case_are_pickled():
    hull = small()
    again = pickle.loads(pickle.dumps(hull))
    assert (again.vertices_m == hull.vertices_m).all() and (again.triangles == hull.triangles).all()
    case = kufe.Case.of(hull, {"load.fz_n": 700.0})
    other = pickle.loads(pickle.dumps(case))
    assert other.to_toml() == case.to_toml() and other.name == case.name


def test_a_scan_is_examined_and_read_as_a_case(tmp_path):
    # A runner in millimetres: unit and axes are found, and its radii.
    hull = kufe.Hull.bob(rocker_radius_m=30.0, section_radius_m=0.005, edge_length_m=0.001)
    path = tmp_path / "scan.obj"
    kufe.Hull(1e3 * hull.vertices_m, hull.triangles).write(path)
    check = kufe.check_hull(path, [500.0, 1000.0], p_max=0.2)
    found = check.result
    assert found["scale"] == 0.001 and found["up"] == "z"
    assert found["rocker_radius_m"] == pytest.approx(30.0, rel=0.02)
    assert found["section_radius_m"] == pytest.approx(0.005, rel=0.02)
    assert [load["fz_n"] for load in found["loads"]] == [500.0, 1000.0]
    assert check.warnings == found["warnings"] and "of 2 loads" in repr(check)
    assert "scale = 0.001" in check.case().to_toml()


def test_a_scan_that_cannot_be_examined_is_named(tmp_path):
    with pytest.raises(kufe.InputError, match="none.obj"):
        kufe.check_hull(tmp_path / "none.obj")
    with pytest.raises(kufe.InputError, match="fz_n = -1: expected positive forces"):
        kufe.check_hull("scan.obj", [-1.0])
    with pytest.raises(kufe.InputError, match="fz_n = -1: expected positive forces"):
        kufe.check_hull("scan.obj", -1.0)
    with pytest.raises(kufe.InputError, match="p_max = 2: expected a relative error"):
        kufe.check_hull("scan.obj", p_max=2.0)
