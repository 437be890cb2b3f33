"""Hulls."""

import numpy as np
import pytest

import kufe


def small(**changes):
    return kufe.Hull.bob(**{"length_m": 0.2, "edge_length_m": 0.004, **changes})


def test_a_runner_has_the_size_that_was_asked():
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


def test_bad_hulls_are_told(tmp_path):
    with pytest.raises(kufe.InputError, match="section"):
        small(section_radius_m=-1.0)
    with pytest.raises(kufe.InputError, match="none.obj"):
        kufe.Hull.read(tmp_path / "none.obj")
    with pytest.raises(kufe.InputError, match="sideways"):
        kufe.Hull.read("bob.obj", forward="sideways")
    with pytest.raises(kufe.InputError, match="xyz"):
        small().write(tmp_path / "bob.xyz")
