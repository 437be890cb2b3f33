#!/usr/bin/env python3
"""Laws of grip hidden at four levels of noise: who finds the formula?

    blind score --kufe target/release/kufe --families recovery/unknown,recovery/pitch-rate-dip --seeds 1 --keep D
    python benches/peers/laws.py D

Next to kufe's own answers in `D/out`: PySINDy's STLSQ on polynomials of second degree, and the symbolic regressors of
pyoperon and gplearn. The peers get what they need served: the low-passed residuals of the base model, what a refit
of the base takes up removed, and the columns that the law may be of; the two regressors the factor on grip itself.

A law is *recovered* where it is of the hidden law's columns alone and follows it within 5 % (root mean square over the
samples of the case without noise, but for a constant, which the base takes up).
Needs numpy, scipy, pandas, scikit-learn, pysindy, pyoperon and gplearn.
"""
import json
import re
import sys
import time
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
from discovery import THIN, base_columns, magic, predict, run_state

WITHIN = 0.05
COLUMNS = ["v_mps", "gamma_rad", "pitch_rate_radps", "roll_rate_radps", "yaw_rate_radps", "delta_rad", "alpha_rad", "t"]
# Name of a case: the columns of its law and its shape, of the size that the answer states.
LAWS = {
    "unknown:pitch_rate_radps": (["pitch_rate_radps"], lambda c: np.abs(c["pitch_rate_radps"])),
    "pitch-rate-dip": (["pitch_rate_radps"], lambda c: np.exp(-(((c["pitch_rate_radps"] + 0.4) / 0.15) ** 2))),
    "unknown:v_mps": (["v_mps"], lambda c: np.exp(-(((c["v_mps"] - 22.0) / 3.0) ** 2))),
    "unknown:v_mps*gamma_rad": (["v_mps", "gamma_rad"], lambda c: c["v_mps"] * c["gamma_rad"]),
}


def samples(folder):
    """Columns, the residual with what a refit of the base takes up removed, and what a factor on grip would do."""
    model = tomllib.loads((folder / "model.toml").read_text())
    sled, friction = model["sled"], model["friction"]
    rows = {"columns": [], "residual": [], "base": [], "grip": []}
    for run in pd.read_csv(folder / "runs.csv").itertuples():
        x = run_state(sled, run, pd.read_csv(folder / run.file))
        inside = slice(25, -25, THIN)
        front = magic(friction["front"], x["slip_f"], x["front"])
        rear = magic(friction["rear"], x["slip_r"], x["rear"])
        arm = (sled["l_f_m"] * front - sled["l_r_m"] * rear) / sled["j_zz_kgm2"]
        measured = np.stack([x["a"][:, 1], x["turning"][:, 2]], 1)
        rows["residual"].append((measured - predict(sled, friction, x)[:, 1:])[inside])
        rows["grip"].append(np.stack([(front + rear) / sled["mass_kg"], arm], 1)[inside])
        rows["base"].append(np.stack([b[inside, 1:] for b in base_columns(sled, friction, x)[1:]], 2))
        rows["columns"].append(np.stack([x[c][inside] for c in COLUMNS], 1))
    columns, residual, base, grip = (np.concatenate(rows[k]) for k in ["columns", "residual", "base", "grip"])
    scale = 1.0 / residual.std(0)
    flat = lambda block: (block * (scale if block.ndim == 2 else scale[:, None])).reshape(-1, *block.shape[2:])
    basis, _ = np.linalg.qr(flat(base))
    free = lambda block: block - basis @ (basis.T @ block)
    return columns, flat(residual), free, grip * scale


def stlsq(case):
    """Sparse terms of second degree; of five thresholds the one that explains most of a third of the rows, not used before."""
    import pysindy

    columns, residual, free, grip = case
    middle, spread = columns.mean(0), columns.std(0)
    library = pysindy.PolynomialLibrary(degree=2, include_bias=False).fit(columns[:1])
    terms = lambda c: np.asarray(library.transform((c - middle) / spread))
    theta = np.asarray(free((terms(columns)[:, None, :] * grip[:, :, None]).reshape(residual.size, -1)))
    y = free(residual)
    size = theta.std(0)
    learn = np.arange(y.size) < 2 * y.size // 3
    best = None
    for threshold in [0.02, 0.05, 0.1, 0.2, 0.5]:
        found = pysindy.STLSQ(threshold=threshold * y.std(), alpha=1e-6).fit(theta[learn] / size, y[learn, None])
        weights = np.ravel(found.coef_) / size
        off = np.square(y[~learn] - theta[~learn] @ weights).sum()
        if best is None or off < best[0]:
            best = (off, weights)
    weights = best[1]
    powers = np.asarray(library.powers_)
    used = {COLUMNS[i] for k in np.flatnonzero(weights) for i in np.flatnonzero(powers[k])}
    return lambda c: terms(c) @ weights, used, f"{np.count_nonzero(weights)} terms"


def factor(case, rows=4000):
    """The factor on grip sample by sample, where grip is strong, and the columns over their spread."""
    columns, residual, free, grip = case
    strong = np.square(grip).sum(1)
    kept = np.flatnonzero(strong > np.median(strong))
    kept = kept[np.linspace(0, kept.size - 1, min(rows, kept.size)).astype(int)]
    y = free(residual).reshape(grip.shape)
    z = (y * grip).sum(1) / strong
    return columns[kept] / columns.std(0), z[kept], columns.std(0)


def operon(case):
    from pyoperon.sklearn import SymbolicRegressor

    x, z, spread = factor(case)
    found = SymbolicRegressor(
        allowed_symbols="add,sub,mul,div,exp,square,abs,constant,variable", max_length=20, generations=300,
        population_size=1000, max_time=30, optimizer_iterations=5, n_threads=2, random_state=1,
    ).fit(x, z)
    text = found.get_model_string(found.model_, precision=4)
    used = {COLUMNS[int(k) - 1] for k in re.findall(r"X(\d+)", text)}
    return lambda c: found.predict(np.ascontiguousarray(c / spread)), used, text


def genetic(case):
    from gplearn.functions import make_function
    from gplearn.genetic import SymbolicRegressor

    x, z, spread = factor(case, 2000)
    bell = make_function(function=lambda a: np.exp(-np.square(np.clip(a, -20, 20))), name="bell", arity=1)
    found = SymbolicRegressor(
        population_size=1000, generations=20, function_set=("add", "sub", "mul", "div", "abs", bell),
        parsimony_coefficient=1e-4 * z.std(), stopping_criteria=0.0, random_state=1,
    ).fit(x, z)
    text = str(found._program)
    used = {COLUMNS[int(k)] for k in re.findall(r"X(\d+)", text)}
    return lambda c: found.predict(c / spread), used, text


def own(folder):
    """kufe's answer: the sum of the laws on grip in the model that it wrote; a claim of anything else is one column more."""
    functions = {"abs": np.abs, "exp": np.exp, "log": np.log, "sqrt": np.sqrt, "sign": np.sign, "tan": np.tan,
                 "atan": np.arctan, "sin": np.sin, "cos": np.cos, "min": np.minimum, "max": np.maximum,
                 "step": lambda x: (x >= 0).astype(float)}
    model = tomllib.loads((folder / "model.next.toml").read_text())
    named = [step["effect"] for step in json.loads((folder / "report.json").read_text())["steps"]]
    laws, used = [], set()
    for name, effect in model.get("effects", {}).items():
        if name not in named or effect.get("channel") != "grip":
            used |= {name} & set(named)
            continue
        text = effect["expression"].replace("t_s", "t")
        used |= set(re.findall(r"[a-z_]+(?:_[a-z0-9]+)+|\bt\b", text)) & set(COLUMNS)
        laws.append((effect["value"], text))
    values = lambda c: {**functions, **{name: c[:, k] for k, name in enumerate(COLUMNS)}}
    of = lambda c: sum((v * eval(t.replace("^", "**"), values(c)) for v, t in laws), np.zeros(len(c)))
    return of, used, "; ".join(f"{v:.4g} {t}" for v, t in laws) or "nothing"


def main(kept):
    warnings.filterwarnings("ignore")
    answers = [json.loads(p.read_text()) | {"stem": p.stem} for p in sorted((kept / "answers").glob("*.json"))]
    quiet = {a["name"]: a["stem"] for a in answers if a["wanted_share"] == 0}
    peers = {"kufe": None, "PySINDy, STLSQ": stlsq, "pyoperon": operon, "gplearn": genetic}
    levels = sorted({a["wanted_share"] for a in answers})
    tally = {(name, level): [0, 0, []] for name in peers for level in levels}
    seconds = dict.fromkeys(peers, 0.0)
    for answer in answers:
        [hidden] = answer["hides"]
        right, shape = LAWS[answer["name"]]
        there = samples(kept / "data" / quiet[answer["name"]])[0]
        truth = hidden["size"] * shape({name: there[:, k] for k, name in enumerate(COLUMNS)})
        case = samples(kept / "data" / answer["stem"])
        for name, peer in peers.items():
            begun = time.perf_counter()
            law, used, text = peer(case) if peer else own(kept / "out" / answer["stem"])
            seconds[name] += time.perf_counter() - begun
            off = law(there) - truth
            error = (off - off.mean()).std() / truth.std()
            row = tally[name, answer["wanted_share"]]
            found = used == set(right) and error <= WITHIN
            row[0] += 1
            row[1] += found
            row[2].append(error)
            print(f"  {answer['name']} @ {answer['wanted_share']:g}  {name}: {'recovered' if found else 'no'}, "
                  f"off by {100 * error:.2g} %, {len(used)} columns: {text[:150]}", file=sys.stderr, flush=True)
    head = " | ".join(f"noise {100 * level:g} %" for level in levels)
    print(f"| recovered (median error) | {head} | s a case |\n|---|{'---|' * len(levels)}---|")
    for name in peers:
        cells = [f"{r} of {n} ({100 * np.median(e):.2g} %)" for n, r, e in (tally[name, level] for level in levels)]
        each = "" if name == "kufe" else f"{seconds[name] / len(answers):.0f}"
        print(f"| {name} | {' | '.join(cells)} | {each} |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: laws.py KEPT")
    main(Path(sys.argv[1]))
