"""Friction of one runner."""

import pytest

import kufe
from test_contact import PARABOLOID
from test_runs import MODEL

def test_friction_is_the_law_at_the_peak_pressure(tmp_path):
    case = kufe.Case(PARABOLOID).replace({"accuracy.p_max": 0.05})
    found = kufe.friction(case, 30.0, alpha_rad=0.01)
    assert found["p_max_pa"] == kufe.press(case).p_max_pa
    assert found["fx_n"] == pytest.approx(-found["mu"] * found["fz_n"], rel=0.02)
    assert found["power_w"] == pytest.approx(30.0 * found["fx_n"])
    model = tmp_path / "model.toml"
    model.write_text(MODEL)
    assert kufe.friction(case, 30.0, model=model)["mu"] == 0.004
    model.write_text(MODEL + "[effects.temperature]\nslope_per_k = -0.01\n")
    with pytest.raises(kufe.Error, match="ice-c"):
        kufe.friction(case, 30.0, model=model)
    assert kufe.friction(case, 30.0, model=model, ice_c=-5.0)["effects"] == ["temperature"]


def test_conditions_out_of_range_are_named():
    case = kufe.Case(PARABOLOID)
    with pytest.raises(kufe.InputError, match="v-mps 200: expected 0 to 100 m/s"):
        kufe.friction(case, 200.0)
    with pytest.raises(kufe.InputError, match="nowhere.toml"):
        kufe.friction(case, 20.0, model="nowhere.toml")


def test_a_friction_table_has_the_points_that_slide_solves():
    case = kufe.Case(PARABOLOID).replace({"load.tilt": "fixed", "accuracy.p_max": 0.05})
    points = kufe.friction_table(case, [10.0, 25.0], [-8.0, -4.0])
    assert [(p["ice_c"], p["v_mps"]) for p in points] == [(-8.0, 10.0), (-8.0, 25.0), (-4.0, 10.0), (-4.0, 25.0)]
    slid = kufe.slide(case, 25.0, -4.0).result
    assert points[3]["mu"] == pytest.approx(slid["mu"], rel=1e-9)
    assert points[3]["mu_error"] > 0
    assert kufe.friction_table(case, 25.0, -4.0) == [points[3]]
    with pytest.raises(kufe.InputError, match="ice_c"):
        kufe.friction_table(case, [10.0], [3.0])
