#!/usr/bin/env python3
"""Blind cases through LassoCV (folds by run) and STLSQ, compared with `kufe discover`.

    blind write --families null,lateral/camber-thrust@0.02 --seeds 3 --data D --answers A
    python benches/peers/discovery.py D A

Both peers get what they need served: the residuals of the base model after a refit, low-passed at
20 Hz and thinned to 20 Hz, and one column for each effect of the catalogue that a sample can show.
A peer *claims* every column with a coefficient, and *names* the one that explains most.
Needs numpy, scipy, pandas, scikit-learn and pysindy.
"""
import json
import sys
import time
import tomllib
import warnings
from datetime import datetime, timezone
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.signal import butter, sosfiltfilt

RATE_HZ, THIN = 100.0, 5


def magic(law, slip, load):
    """Side force of a runner: D sin(C atan(Bx - E (Bx - atan Bx))), D = mu zeta Fz, B = K / (C D)."""
    peak = law["mu_zeta"] * load
    bx = law["k_n_per_rad"] / (law["c"] * peak) * slip
    bent = bx - law["e"] * (bx - np.arctan(bx))
    return peak * np.sin(law["c"] * np.arctan(bent))


def smooth(values):
    return sosfiltfilt(butter(2, 20.0, fs=RATE_HZ, output="sos"), values, axis=0)


def run_state(sled, run, table):
    """Loads, slips and accelerations at the centre of gravity of one run, low-passed."""
    f = {name: smooth(table[name].to_numpy(float)) for name in table.columns if name != "t_s"}
    rates = np.stack([f["roll_rate_radps"], f["pitch_rate_radps"], f["yaw_rate_radps"]], 1)
    turning = np.gradient(rates, 1.0 / RATE_HZ, axis=0)
    place = np.array([sled["accel_x_m"], sled["accel_y_m"], sled["accel_z_m"]])
    felt = np.stack([f["ax_mps2"], f["ay_mps2"], f["az_mps2"]], 1)
    a = felt - np.cross(turning, place) - np.cross(rates, np.cross(rates, place))
    m, base = sled["mass_kg"], sled["l_f_m"] + sled["l_r_m"]
    front = (sled["l_r_m"] * m * a[:, 2] - sled["j_yy_kgm2"] * turning[:, 1]) / base
    v, yaw = f["v_mps"], rates[:, 2]
    back = f["alpha_rad"] - yaw * (-sled["l_r_m"] - sled["slip_x_m"]) / v
    ahead = f["alpha_rad"] - yaw * (sled["l_f_m"] - sled["slip_x_m"]) / v + f["delta_rad"]
    beta = -(f["alpha_rad"] + yaw * sled["slip_x_m"] / v)
    return dict(
        f, a=a, turning=turning, front=front, rear=m * a[:, 2] - front, slip_f=ahead, slip_r=back,
        beta=beta, yaw=yaw, v=v, t=np.arange(len(v)) / RATE_HZ, ice=float(run.ice_c),
        density=float(run.air_pa) / (287.05 * (float(run.air_c) + 273.15)), session=run.session,
    )


def predict(sled, friction, x):
    """Longitudinal and lateral acceleration and yaw acceleration of the base model."""
    sg, cg, sd, cd = np.sin(x["gamma_rad"]), np.cos(x["gamma_rad"]), np.sin(x["delta_rad"]), np.cos(x["delta_rad"])
    mu, load = friction["longitudinal"]["mu"], x["front"]
    for _ in range(3):
        fx, fy = -mu * load * np.cos(x["slip_f"]), magic(friction["front"], x["slip_f"], load)
        load = (x["front"] - sg * (sd * fx + cd * fy)) / cg
    along = cd * fx - sd * fy
    side = cg * (sd * fx + cd * fy) - sg * load
    rear = magic(friction["rear"], x["slip_r"], x["rear"])
    area = sled["cda_m2"] * (1.0 + sled["yaw_drag_per_deg"] * np.degrees(np.abs(x["beta"])))
    drag = 0.5 * x["density"] * area * x["v"] ** 2
    m = sled["mass_kg"]
    back = -mu * x["rear"] * np.cos(x["slip_r"])
    return np.stack([
        (along + back - drag) / m,
        (side + rear) / m,
        (sled["l_f_m"] * side - sled["l_r_m"] * rear) / sled["j_zz_kgm2"],
    ], 1)


def columns(sled, friction, x):
    """One column an effect, for the longitudinal and for the two lateral channels."""
    m, l_f, l_r, j = sled["mass_kg"], sled["l_f_m"], sled["l_r_m"], sled["j_zz_kgm2"]
    mu, n = friction["longitudinal"]["mu"], x["front"] + x["rear"]
    v, air = x["v"], 0.5 * x["density"] * x["v"] ** 2
    front = magic(friction["front"], x["slip_f"], x["front"])
    rear = magic(friction["rear"], x["slip_r"], x["rear"])
    one = np.ones_like(v)
    long = {
        "temperature": -mu * n * (x["ice"] + 5.0), "speed": -mu * n * np.log(v / 25.0),
        "load": -mu * n * np.log(np.maximum(n, 1.0) / 2000.0), "plowing": -np.maximum(n, 0.0) ** 1.5 / 1e3,
        "warm-up": -mu * n * np.exp(-x["t"] / 10.0), "drag-area": -air, "headwind": -x["density"] * sled["cda_m2"] * v,
        "slip-drag": -np.abs(front * x["slip_f"]) - np.abs(rear * x["slip_r"]),
        "steer-drag": -x["front"] * np.abs(x["delta_rad"]), "roll-split-drag": -air * np.abs(x["gamma_rad"]),
        "aero-yaw": -air * np.abs(x["beta"]), "accelerometer-bias": one,
    }
    if "humidity_pct" in x:
        long["humidity"] = -mu * n * (x["humidity_pct"] - 70.0)
        long["wear"] = -mu * n * x["distance_m"]
    long["unknown:roll_rate"] = -n * np.abs(x["roll_rate_radps"])
    if "runner_c" in x:
        long["unknown:runner_c"] = -n * (x["runner_c"] + 3.0)

    def pair(f, r):
        return np.stack([(f + r) / m, (l_f * f - l_r * r) / j], 1)

    def by_slip(d_f, d_r):
        h = 1e-4
        return pair(
            (magic(friction["front"], x["slip_f"] + h * d_f, x["front"]) - front) / h,
            (magic(friction["rear"], x["slip_r"] + h * d_r, x["rear"]) - rear) / h,
        )

    rate = np.gradient(x["alpha_rad"]) * RATE_HZ
    rate_f, rate_r = np.gradient(x["slip_f"]) * RATE_HZ, np.gradient(x["slip_r"]) * RATE_HZ
    zero = np.zeros_like(v)
    lateral = {
        "temperature-grip": pair(front, rear) * (x["ice"] + 5.0), "speed-grip": pair(front * (v - 25), rear * (v - 25)),
        "load-sensitivity": pair(front * np.log(np.maximum(x["front"], 1) / 2000), rear * np.log(np.maximum(x["rear"], 1) / 2000)),
        "load-transfer": pair(front, rear) * (x["turning"][:, 0] ** 2)[:, None],
        "camber-thrust": pair(x["front"] * x["gamma_rad"], zero),
        "saturation": pair(front ** 3 / x["front"] ** 2, rear ** 3 / x["rear"] ** 2),
        "combined-slip": pair(front, rear) * ((x["a"][:, 0] / x["a"][:, 2]) ** 2)[:, None],
        "relaxation-length": by_slip(-rate_f / v, -rate_r / v), "slip-lag": by_slip(rate, rate),
        "slip-offset": by_slip(-one, -one), "slip-scale": by_slip(-x["alpha_rad"], -x["alpha_rad"]),
        "steer-offset": by_slip(-one, zero), "lever-arm": np.stack([x["turning"][:, 2], zero], 1),
        "accelerometer-bias": np.stack([one, zero], 1), "accelerometer-tilt": np.stack([x["a"][:, 2], zero], 1),
    }
    return long, lateral


def base_columns(sled, friction, x):
    """Derivatives of the prediction to mu, and to the peak and stiffness of both runners."""
    start, found = predict(sled, friction, x), []
    for part, key in [("longitudinal", "mu"), ("front", "mu_zeta"), ("front", "k_n_per_rad"), ("rear", "mu_zeta"), ("rear", "k_n_per_rad")]:
        moved = {name: dict(law) for name, law in friction.items()}
        moved[part][key] *= 1.01
        found.append(predict(sled, moved, x) - start)
    return found


def load(folder):
    """Residual, base columns and candidates of a case, by channel, with the runs as groups."""
    model = tomllib.loads((folder / "model.toml").read_text())
    sled, friction = model["sled"], model["friction"]
    parts = {"longitudinal": [], "lateral": []}
    for group, run in enumerate(pd.read_csv(folder / "runs.csv").itertuples()):
        x = run_state(sled, run, pd.read_csv(folder / run.file))
        inside = slice(25, -25, THIN)
        measured = np.stack([x["a"][:, 0], x["a"][:, 1], x["turning"][:, 2]], 1)
        residual, base = measured - predict(sled, friction, x), base_columns(sled, friction, x)
        long, lateral = columns(sled, friction, x)
        parts["longitudinal"].append((residual[inside, :1], [base[0][inside, :1]], {k: c[inside, None] for k, c in long.items()}, group))
        parts["lateral"].append((residual[inside, 1:], [b[inside, 1:] for b in base[1:]], {k: c[inside] for k, c in lateral.items()}, group))
    for channel, runs in parts.items():
        target = np.concatenate([r[0] for r in runs])
        scale = 1.0 / target.std(0)
        flat = lambda pick: np.concatenate([(pick(r) * scale).T.ravel() for r in runs])
        y = flat(lambda r: r[0])
        base = np.stack([flat(lambda r, k=k: r[1][k]) for k in range(len(runs[0][1]))], 1)
        names = list(runs[0][2])
        library = np.stack([flat(lambda r, name=name: r[2][name]) for name in names], 1)
        groups = np.concatenate([np.full(r[0].size, r[3]) for r in runs])
        q, _ = np.linalg.qr(base)
        y, library = y - q @ (q.T @ y), library - q @ (q.T @ library)
        library /= library.std(0) + 1e-300
        yield channel, y / y.std(), library, names, groups


def lasso(y, library, groups):
    from sklearn.linear_model import LassoCV
    from sklearn.model_selection import GroupKFold

    folds = list(GroupKFold(5).split(library, y, groups))
    return LassoCV(cv=folds, alphas=40, max_iter=4000).fit(library, y).coef_


def stlsq(y, library, threshold):
    import pysindy

    return np.ravel(pysindy.STLSQ(threshold=threshold, alpha=1e-6).fit(library, y[:, None]).coef_)


def main(data, answers):
    warnings.filterwarnings("ignore")
    peers = {
        "LassoCV by run": lambda y, x, g: lasso(y, x, g),
        "STLSQ, threshold 0.05": lambda y, x, g: stlsq(y, x, 0.05),
        "STLSQ, threshold 0.1": lambda y, x, g: stlsq(y, x, 0.1),
    }
    tally = {name: dict(nulls=0, claimed=0, effects=0, exact=0, within=0, extra=0, s=0.0) for name in peers}
    for path in sorted(answers.glob("*.json")):
        answer = json.loads(path.read_text())
        folder = data / path.stem
        if answer["data"] != "runs.csv" or not folder.is_dir():
            continue
        truth = [h["effect"] for h in answer["hides"]]
        channels = list(load(folder))
        for name, peer in peers.items():
            start, claims = time.perf_counter(), []
            for _, y, library, names, groups in channels:
                weight = np.abs(peer(y, library, groups))
                claims += [(w, n) for w, n in zip(weight, names) if w > 1e-9]
            row = tally[name]
            row["s"] += time.perf_counter() - start
            claims.sort(reverse=True)
            if truth:
                row["effects"] += 1
                row["exact"] += bool(claims) and claims[0][1] in truth
                row["within"] += any(n in truth for _, n in claims)
                row["extra"] += sum(n not in truth for _, n in claims)
            else:
                row["nulls"] += 1
                row["claimed"] += bool(claims)
    print(f"Peers on blind cases, {datetime.now(timezone.utc):%Y-%m-%d}\n")
    print("| method | nulls | false claims | effects | largest term is the effect | effect among the terms | wrong terms a case | s a case |")
    print("|---|---|---|---|---|---|---|---|")
    share = lambda a, b: f"{100 * a / b:.0f} %" if b else "-"
    for name, r in tally.items():
        per = f"{r['extra'] / r['effects']:.1f}" if r["effects"] else "-"
        cases = max(r["nulls"] + r["effects"], 1)
        print(f"| {name} | {r['nulls']} | {share(r['claimed'], r['nulls'])} | {r['effects']} | {share(r['exact'], r['effects'])} "
              f"| {share(r['within'], r['effects'])} | {per} | {r['s'] / cases:.1f} |")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: discovery.py DATA ANSWERS")
    main(Path(sys.argv[1]), Path(sys.argv[2]))
