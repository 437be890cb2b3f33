#!/usr/bin/env python3
"""Formulas that no catalogue has, hidden in runs: which of them `kufe discover`, PySINDy and Operon give back.

    python benches/peers/formulas.py --kufe target/release/kufe --work FOLDER [--seeds 1 2] [--noise 0 0.001 0.01 0.1]

A sled is driven as the balances ask: speed, rates, loads, steering and roll split are smooth and random, the slip angle is the one with which the
moments about the vertical balance, and the accelerometer reads what the forces then are. The side forces are those of the published sled
times 1 + g(columns); g is one of six forms, its columns and numbers drawn by the seed, its scatter 5 %. Each channel gets white noise, a share of
its own root mean square (of its scatter for the speed).

`kufe` gets the runs, the sled with its true installation (tolerances of 0) and friction 2 % off. The peers get more: the true friction, and the ratio of
what is measured to what the forces without g would be, both low-passed at 4 Hz, where these are strong, over the same columns.

The rule, stated before anything was scored: g is *recovered* where what is found, less g and less a constant, is in the mean below 1 % of g's own mean
deviation, over columns drawn by themselves and evenly from their range widened by half of it on either side. It is *close* where that is below 5 % within
the range. What does the same in the data and bends away beside them is not the formula.
"""
import argparse
import json
import subprocess
import tomllib
import warnings
from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfiltfilt

from discovery import magic

HZ, SECONDS, RUNS = 100.0, 20.0, 24
SLED = dict(mass_kg=390.0, j_yy_kgm2=145.0, j_zz_kgm2=150.0, l_f_m=0.82, l_r_m=0.88, accel_x_m=0.0, accel_y_m=0.0, accel_z_m=0.0,
            slip_x_m=0.0, cda_m2=0.28, yaw_drag_per_deg=0.0)
FRICTION = dict(longitudinal=dict(mu=0.004), front=dict(mu_zeta=2.577, c=0.024, e=0.99, k_n_per_rad=10522.0),
                rear=dict(mu_zeta=3.288, c=0.076, e=0.99, k_n_per_rad=49776.0))
COLUMNS = ["v_mps", "pitch_rate_radps", "roll_rate_radps", "gamma_rad", "delta_rad"]
FORMS = ["line", "power", "exponential", "step", "hump", "product"]
RECORDED = ["ax_mps2", "ay_mps2", "az_mps2", "roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps", "v_mps", "alpha_rad", "delta_rad", "gamma_rad"]
KIND = dict(zip(RECORDED, ["accel_mps2"] * 3 + ["rate_radps"] * 3 + ["speed_mps", "slip_rad", "steer_rad", "roll_split_rad"]))


def wave(rng, t, slowest, fastest, size):
    """A smooth random signal: sines of periods between these [s]."""
    periods = np.exp(rng.uniform(np.log(fastest), np.log(slowest), 6))
    phases = rng.uniform(0, 2 * np.pi, 6)
    value = sum(np.sin(2 * np.pi * t / p + a) for p, a in zip(periods, phases)) * size / np.sqrt(3)
    rate = sum(2 * np.pi / p * np.cos(2 * np.pi * t / p + a) for p, a in zip(periods, phases)) * size / np.sqrt(3)
    return value, rate


def drive(rng):
    """One run without its slip angle: what is prescribed."""
    t = np.arange(0, SECONDS, 1 / HZ)
    roll, roll_rate = wave(rng, t, 12, 2.5, 0.5)
    pitch, pitch_rate = wave(rng, t, 12, 2.5, 0.25)
    yaw, yaw_rate = wave(rng, t, 12, 2.5, 0.2)
    v = 12 + 0.8 * t + wave(rng, t, 15, 5, 0.8)[0]
    x = dict(t=t, v=v, v_mps=v, roll_rate_radps=roll, pitch_rate_radps=pitch, yaw_rate_radps=yaw, yaw=yaw,
             turning=np.stack([roll_rate, pitch_rate, yaw_rate], 1), az=12.0 + wave(rng, t, 12, 2.5, 2.0)[0],
             delta_rad=wave(rng, t, 12, 2.0, 0.03)[0], gamma_rad=wave(rng, t, 12, 2.0, 0.04)[0], density=96_000.0 / (287.05 * 275.15))
    base = SLED["l_f_m"] + SLED["l_r_m"]
    x["front"] = (SLED["l_r_m"] * SLED["mass_kg"] * x["az"] - SLED["j_yy_kgm2"] * pitch_rate) / base
    x["rear"] = SLED["mass_kg"] * x["az"] - x["front"]
    return x


def balance(x, alpha, g):
    """Accelerations forward, to the left and about the vertical at this slip angle, side forces being 1 + g times the law's."""
    slip_r = alpha + x["yaw"] * SLED["l_r_m"] / x["v"]
    slip_f = alpha - x["yaw"] * SLED["l_f_m"] / x["v"] + x["delta_rad"]
    sg, cg, sd, cd = np.sin(x["gamma_rad"]), np.cos(x["gamma_rad"]), np.sin(x["delta_rad"]), np.cos(x["delta_rad"])
    mu, load = FRICTION["longitudinal"]["mu"], x["front"]
    for _ in range(4):
        fx, fy = -mu * load * np.cos(slip_f), magic(FRICTION["front"], slip_f, load)
        load = (x["front"] - sg * (sd * fx + cd * fy)) / cg
    fy, rear = (1 + g) * fy, (1 + g) * magic(FRICTION["rear"], slip_r, x["rear"])
    side = cg * (sd * fx + cd * fy) - sg * load
    drag = 0.5 * x["density"] * SLED["cda_m2"] * x["v"] ** 2
    # The air pushes against the driving direction, which points by alpha to the right of the axis.
    along = cd * fx - sd * fy - mu * x["rear"] * np.cos(slip_r) - drag * np.cos(alpha)
    turn = (SLED["l_f_m"] * side - SLED["l_r_m"] * rear) / SLED["j_zz_kgm2"]
    scaled = cg * cd * fy + rear
    across = side + rear + drag * np.sin(alpha)
    return along / SLED["mass_kg"], across / SLED["mass_kg"], turn, scaled / SLED["mass_kg"]


def recorded(x, g):
    """What perfect sensors say: the slip angle with which moments balance, found by halving, and the accelerations there."""
    low, high = np.full_like(x["t"], -0.06), np.full_like(x["t"], 0.06)
    for _ in range(60):
        middle = 0.5 * (low + high)
        above = balance(x, middle, g)[2] > x["turning"][:, 2]
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    ax, ay, _, _ = balance(x, middle, g)
    return dict({name: x[name] for name in RECORDED if name in x}, ax_mps2=ax, ay_mps2=ay, az_mps2=x["az"], alpha_rad=middle)


def draw(form, rng, runs):
    """A formula of this form: what it is in words and as a function of columns, and the columns that it has."""
    every = {c: np.concatenate([x[c] for x in runs]) for c in COLUMNS}
    first, second = rng.choice(COLUMNS, 2, replace=False)
    low, high = np.quantile(every[first], [0.01, 0.99])
    scale, span = max(abs(low), abs(high)), high - low
    at = low + rng.uniform(0.3, 0.7) * span
    power, width, share = rng.uniform(1.3, 2.7), rng.uniform(0.12, 0.25) * span, rng.uniform(0.3, 0.8) * rng.choice([-1, 1])
    made = {
        "line": (f"{first}", lambda c: c[first], [first]),
        "power": (f"(|{first}| / {scale:.4g})^{power:.3f}", lambda c: (np.abs(c[first]) / scale) ** power, [first]),
        "exponential": (f"exp({first} / {share * span:.4g})", lambda c: np.exp(c[first] / (share * span)), [first]),
        "step": (f"step({first} - {at:.4g})", lambda c: 1.0 * (c[first] > at), [first]),
        "hump": (f"exp(-(({first} - {at:.4g}) / {width:.4g})^2)", lambda c: np.exp(-(((c[first] - at) / width) ** 2)), [first]),
        "product": (f"{first} * {second}", lambda c: c[first] * c[second], [first, second]),
    }
    text, shape, names = made[form]
    size = rng.choice([-1, 1]) * 0.05 / np.std(shape(every))
    return f"{size:.4g} {text}", lambda c: size * shape(c), names, every


def error(found, truth, every, rng, widened):
    """Mean deviation of found from truth, a constant apart, over the truth's own."""
    columns = {}
    for name, values in every.items():
        low, high = np.quantile(values, [0.01, 0.99])
        beside = 0.5 * (high - low) * widened
        columns[name] = rng.uniform(low - beside, high + beside, 20_000)
    with np.errstate(all="ignore"):
        own, other = truth(columns), np.broadcast_to(found(columns), (20_000,))
    if not np.isfinite(other).all():
        return np.inf
    away = lambda x: np.mean(np.abs(x - np.median(x)))
    return away(other - own) / away(own)


def write(folder, runs, noise):
    folder.mkdir(parents=True, exist_ok=True)
    index = ["run,file,track,driver,driver_class,session,ice_c,air_c,air_pa"]
    for k, run in enumerate(runs):
        index.append(f"r{k:02},r{k:02}.csv,bahn,d{k % 3},all,{k // 3},-6,2,96000")
        table = np.column_stack([np.arange(len(run["v_mps"])) / HZ] + [run[c] for c in RECORDED])
        np.savetxt(folder / f"r{k:02}.csv", table, "%.10g", ",", header=",".join(["t_s"] + RECORDED), comments="")
    (folder / "runs.csv").write_text("\n".join(index) + "\n")
    off = dict(longitudinal=dict(mu=0.00408), front=dict(FRICTION["front"], mu_zeta=2.53, k_n_per_rad=10732.0),
               rear=dict(FRICTION["rear"], mu_zeta=3.35, k_n_per_rad=48780.0))
    off["longitudinal"] = dict(mu=0.00408)
    tables = {"sled": SLED, **{f"friction.{name}": part for name, part in off.items()}, "noise": noise,
              "tolerances": dict.fromkeys(["delay_s", "place_m", "gyro_scale", "gyro_bias_radps", "accel_scale", "accel_bias_mps2", "mass", "inertia", "steer_scale"], 0.0)}
    text = "".join(f"[{name}]\n" + "".join(f"{k} = {float(v)!r}\n" for k, v in part.items()) + "\n" for name, part in tables.items())
    (folder / "model.toml").write_text(text)


def kufe(command, folder):
    """The formulas on the grip that model.next.toml has, as a function; nothing where it has another effect beside them."""
    done = subprocess.run([command, "discover", "runs.csv", "--model", "model.toml", "-o", "out"], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        return f"exit code {done.returncode}: {done.stderr.strip()[-200:]}", None
    effects = tomllib.loads((folder / "out/model.next.toml").read_text()).get("effects", {})
    names = dict(abs=np.abs, exp=np.exp, sqrt=np.sqrt, log=np.log, step=lambda x: 1.0 * (x > 0), sign=np.sign)
    text = "; ".join(f"{e['channel']}: {e['value']:.4g} {e['expression']}" if "expression" in e else n for n, e in effects.items())
    if not effects or any(e.get("channel") != "grip" for e in effects.values()):
        return text or "nothing", None
    codes = [(e["value"], compile(e["expression"].replace("^", "**"), n, "eval")) for n, e in effects.items()]
    return text, lambda c: sum(v * eval(code, dict(names, **c)) for v, code in codes) + 0 * c["v_mps"]


def served(runs, g_free):
    """What the peers get: columns and the ratio of side forces to the known ones less 1, low-passed, where these are strong."""
    sieve = butter(2, 4.0, fs=HZ, output="sos")
    rows, ratio = [], []
    for run, x in zip(runs, g_free):
        low = {name: sosfiltfilt(sieve, run[name]) for name in RECORDED}
        known = dict(x, v=low["v_mps"], yaw=low["yaw_rate_radps"], **{c: low[c] for c in COLUMNS})
        _, ay, _, scaled = balance(known, low["alpha_rad"], 0.0)
        scaled, left = sosfiltfilt(sieve, scaled), low["ay_mps2"] - sosfiltfilt(sieve, ay)
        strong = (np.abs(scaled) > 0.25) & (np.arange(len(ay)) % 20 == 0)
        strong[:50] = strong[-50:] = False
        rows.append(np.column_stack([low[c] for c in COLUMNS])[strong])
        ratio.append((left / scaled)[strong])
    return np.concatenate(rows), np.concatenate(ratio), np.concatenate([np.full(len(r), k) for k, r in enumerate(ratio)])


def sindy(x, y, groups):
    """STLSQ over polynomials to the third degree, sizes and exponentials; its threshold by runs left out."""
    import pysindy

    centre, spread = x.mean(0), x.std(0)

    def library(c):
        z = (np.column_stack([c[name] for name in COLUMNS]) - centre) / spread
        n = z.shape[1]
        terms = [np.ones(len(z))] + [z[:, i] for i in range(n)] + [z[:, i] * z[:, j] for i in range(n) for j in range(i, n)]
        terms += [z[:, i] * z[:, j] * z[:, k] for i in range(n) for j in range(i, n) for k in range(j, n)]
        raw = z + centre / spread
        return np.column_stack(terms + [np.abs(raw[:, i]) for i in range(n)] + [np.exp(s * z[:, i]) for i in range(n) for s in (-1, 1)])

    theta = library({c: x[:, k] for k, c in enumerate(COLUMNS)})
    fit = lambda rows, threshold: np.ravel(pysindy.STLSQ(threshold=threshold, alpha=1e-6).fit(theta[rows], y[rows, None]).coef_)
    learn = groups % 4 != 3
    judge = lambda threshold: np.mean((y[~learn] - theta[~learn] @ fit(learn, threshold)) ** 2)
    best = min([0.002, 0.005, 0.01, 0.02, 0.04], key=judge)
    coefficients = fit(slice(None), best)
    return f"{np.count_nonzero(coefficients)} terms", lambda c: library(c) @ coefficients


def operon(x, y, seed):
    """Operon's genetic programming with its own choice by description length."""
    from pyoperon.sklearn import SymbolicRegressor

    model = SymbolicRegressor(allowed_symbols="add,sub,mul,div,exp,log,sqrt,square,abs,pow,constant,variable", generations=500, population_size=500,
                              max_evaluations=30_000, optimizer_iterations=5, max_length=25, n_threads=1, random_state=seed,
                              model_selection_criterion="minimum_description_length")
    model.fit(x, y)
    return model.get_model_string(model.model_, 4, names=COLUMNS), lambda c: model.predict(np.column_stack([c[n] for n in COLUMNS]))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kufe", type=Path, default=Path("target/release/kufe"))
    parser.add_argument("--methods", nargs="+", default=["kufe", "PySINDy", "Operon"])
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--noise", type=float, nargs="+", default=[0.0, 0.001, 0.01, 0.1])
    parser.add_argument("--forms", nargs="+", default=FORMS)
    ask = parser.parse_args()
    warnings.filterwarnings("ignore")
    tally = {}
    for seed in ask.seeds:
        for form in ask.forms:
            rng = np.random.default_rng([seed, FORMS.index(form)])
            plans = [drive(rng) for _ in range(RUNS)]
            text, law, _, every = draw(form, rng, plans)
            clean = [recorded(x, law(x)) for x in plans]
            for share in ask.noise:
                group = {}
                for c in RECORDED:
                    values = np.concatenate([run[c] for run in clean])
                    size = np.std(values) if c in ("v_mps", "az_mps2") else np.sqrt(np.mean(values**2))
                    group.setdefault(KIND[c], []).append(share * size)
                # One number a kind of sensor is what a model states: the axes share their mean.
                noise = {kind: float(np.mean(sizes)) for kind, sizes in group.items()}
                own = np.random.default_rng([seed, FORMS.index(form), 7])
                noisy = [{c: run[c] + noise[KIND[c]] * own.standard_normal(len(run[c])) for c in RECORDED} for run in clean]
                answers = {}
                if "kufe" in ask.methods:
                    folder = ask.work / f"{form}-{seed}-{share}"
                    write(folder, noisy, {kind: max(sd, 1e-9) for kind, sd in noise.items()})
                    answers["kufe"] = kufe(ask.kufe.resolve(), folder)
                x, y, groups = served(noisy, plans)
                if "PySINDy" in ask.methods:
                    answers["PySINDy"] = sindy(x, y, groups)
                if "Operon" in ask.methods:
                    answers["Operon"] = operon(x, y, seed)
                for method, (said, found) in answers.items():
                    errors = [np.inf, np.inf] if found is None else [error(found, law, every, np.random.default_rng(5), w) for w in (1.0, 0.0)]
                    counts = tally.setdefault((method, share), [0, 0, 0])
                    counts[0] += 1
                    counts[1] += errors[0] < 0.01
                    counts[2] += errors[1] < 0.05
                    print(json.dumps(dict(form=form, seed=seed, noise=share, hidden=text, method=method, said=said[:200],
                                          widened=round(float(errors[0]), 4), within=round(float(errors[1]), 4))), flush=True)
    print("| method | noise | formulas | recovered | close |\n|---|---|---|---|---|")
    for (method, share), (count, exact, close) in sorted(tally.items()):
        print(f"| {method} | {100 * share:g} % | {count} | {exact} | {close} |")


if __name__ == "__main__":
    main()
