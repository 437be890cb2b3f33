// The page of a lookup table.
//
// Data: { name, axes: [{ name, points, from, to, outside }], fz, curvature, flush or null, layers: [name] or null, nodes, thinned, check_count,
// checks: [{ fz, curvature, layer }], by_boundary_elements, quantities: [{ name, label, unit, times, errors: { mode: number }, values:
// [layer][fz][curvature], solver: the same or null, check_errors: [number or null] }], solver_error, judged, interpolation_requested, case, case_sha256, version }.
// A layer is one of the runner's rocker radii, speeds and temperatures of the ice; judged is the quantity whose errors are requested.
// With flush [curvature, scale, from, to] the numbers in `curvature` are reduced curvatures, 0 to 1.

const AXES = {
  fz_n: ["normal force", "N"], curvature_1pm: ["track curvature", "1/m"], rocker_radius_m: ["rocker radius", "m"],
  v_mps: ["speed", "m/s"], ice_c: ["ice temperature", "\u00b0C"],
};
/** An error between nodes that the page warns of. */
const LARGE = 0.05;

function tablePage(main, data) {
  const { reduced, curvatureAt } = reductionOf(data.flush);
  const ends = data.flush ? data.flush.slice(2) : [data.curvature[0], data.curvature[data.curvature.length - 1]];
  const space = stage("the quantity over force and curvature; drag to turn, scroll to come closer");
  const readout = el("output", { class: "readout", id: "readout" }, "");
  const quantity = el("select", { id: "quantity", onchange: () => draw() }, data.quantities.map((q, k) => el("option", { value: k }, q.label)));
  const layer = el("select", { onchange: () => draw() }, (data.layers ?? [""]).map((name, k) => el("option", { value: k }, name)));
  const judged = data.quantities.findIndex((q) => q.name === data.judged), ofJudged = data.judged === "mu" ? "friction" : "peak";
  quantity.value = judged;
  const overForce = chart(), overCurvature = chart();
  const map = heatMap((x, y) => say(x, y)), errorMap = heatMap((x, y) => sayError(x, y));
  const errorReadout = el("output", { class: "readout" }, "");
  const ofChecks = data.quantities[judged].check_errors.map((error, k) => [error ?? 0, data.checks[k]]).sort((a, b) => b[0] - a[0]);
  const placeOf = (check) => `${figure(check.fz, 4)} N, ${figure(check.curvature, 3)} 1/m${check.layer ? `, ${check.layer}` : ""}`;
  const fact = (text) => el("p", { class: "soft" }, text);
  const percent = (value) => (value === null || value === undefined ? "not measured" : `${figure(100 * value, 2)} %`);
  main.replaceChildren(
    el("header", {}, el("h1", {}, data.name), fact(`Lookup table of ${data.nodes} solved contacts over normal force and track curvature${data.layers ? `, ${data.layered}` : ""}.${data.by_boundary_elements ? ` Of nodes and checks ${data.by_boundary_elements} were solved by boundary elements, the others by finite elements.` : ""}`)),
    el("ul", { class: "figures" }, figures([
      ...data.axes.map((axis) => [`${figure(axis.from, 4)} to ${figure(axis.to, 4)} ${AXES[axis.name][1]}`, `${AXES[axis.name][0]}, ${axis.points} breakpoints; outside: ${axis.outside}`]),
      [percent(data.solver_error), `largest solver error of the ${ofJudged}`],
      [percent(data.quantities[judged].errors.smooth), `largest smooth interpolation error, at ${data.check_count} solves between nodes`],
      [percent(data.quantities[judged].errors.bilinear), "the same, bilinear"],
    ])),
    ofChecks.length && ofChecks[0][0] > LARGE ? el("p", { class: "warning" }, `Between the nodes the ${ofJudged} is off by up to ${percent(ofChecks[0][0])}, at ${placeOf(ofChecks[0][1])}: more breakpoints there, or an axis with from and to, reduce it.`) : "",
    data.thinned ? el("p", { class: "warning" }, "The table is finer than this page, which carries some of its breakpoints only.") : "",
    el("div", { class: "tools", style: "margin-bottom:.8rem" }, el("label", {}, "quantity", quantity), el("label", { hidden: !data.layers }, data.layered, layer)),
    el("div", { class: "panels" },
      panel("Surface", space.box),
      panel("Map", map.box, readout, fact(`Between breakpoints (dots) values are bilinear here${data.flush ? " over reduced curvature" : ""}, as in Simulink's n-D lookup table.`)),
      panel("Stated error", errorMap.box, errorReadout, fact("Colour: the solver's relative error, between the nodes. Large dots: relative error of smooth interpolation at the solves between nodes, of all layers.")),
      panel("Over normal force", overForce.box),
      panel("Over track curvature", overCurvature.box),
      panel("Interpolation", table(["quantity", "smooth", "bilinear"], data.quantities.map((q) => [q.label, percent(q.errors.smooth), percent(q.errors.bilinear)])),
        fact(`Largest relative error at ${data.check_count} solves that are no nodes${data.interpolation_requested ? `; requested of the ${ofJudged}: ${percent(data.interpolation_requested)}` : ""}.`)),
      panel("The case", caseOf(data.case, [["sha256 of case and hull", data.case_sha256], ["made by", `kufe ${data.version}`]]))),
  );

  let at = null;
  function say(fz, curvature) {
    const value = at(fz, curvature), { unit, times } = data.quantities[quantity.value];
    const radius = curvature === 0 ? "straight" : `radius ${figure(1 / curvature, 4)} m`;
    readout.textContent = `Fz ${figure(fz, 5)} N, curvature ${figure(curvature, 4)} 1/m (${radius}): ${figure(times * value, 5)} ${unit}`;
  }
  let errorAt = null;
  function sayError(fz, curvature) {
    const solver = errorAt(fz, curvature), shown = data.quantities[quantity.value].check_errors;
    const worst = shown.reduce((best, error, k) => (error !== null && (best < 0 || error > shown[best]) ? k : best), -1);
    const between = worst < 0 ? "" : `; interpolation: up to ${percent(shown[worst])}, at ${placeOf(data.checks[worst])}`;
    errorReadout.textContent = `Fz ${figure(fz, 5)} N, curvature ${figure(curvature, 4)} 1/m: solver ${Number.isFinite(solver) ? percent(solver) : "not stated"}${between}`;
  }

  function draw() {
    const { label, unit, times, values: layers } = data.quantities[quantity.value], values = layers[layer.value], title = unit ? `${label} [${unit}]` : label;
    const all = values.flat().map((value) => times * value), [low, high] = [Math.min(...all), Math.max(...all)];
    const held = (fz) => Math.min(Math.max(fz, data.fz[0]), data.fz[data.fz.length - 1]), inTable = between(data.fz, data.curvature, values);
    at = (fz, curvature) => inTable(fz, reduced(held(fz), curvature));
    const [xs, ys] = [data.fz, ends].map(span), [nx, ny] = [200, data.flush ? 280 : 140];
    const x = (i) => xs[0] + (i + 0.5) / nx * (xs[1] - xs[0]), y = (j) => ys[0] + (j + 0.5) / ny * (ys[1] - ys[0]);
    map.draw({
      x: [...xs, "normal force [N]"], y: [...ys, "track curvature [1/m]"], bar: [low, high, title],
      image: { nx, ny, x: xs, y: ys, value: (i, j) => times * at(x(i), y(j)), draws: Number.isFinite },
      dots: data.fz.flatMap((f) => data.curvature.map((c) => [f, curvatureAt(f, c)])),
    });
    const middleForce = data.fz[Math.floor(data.fz.length / 2)], middle = [middleForce, curvatureAt(middleForce, data.curvature[Math.floor(data.curvature.length / 2)])];
    map.point(...middle);
    say(...middle);
    const solver = data.quantities[quantity.value].solver?.[layer.value], ofQuantity = data.quantities[quantity.value].check_errors;
    const inErrors = solver && between(data.fz, data.curvature, solver);
    errorAt = (fz, curvature) => (inErrors ? inErrors(fz, reduced(held(fz), curvature)) : NaN);
    const most = 100 * Math.max(1e-6, ...(solver ?? []).flat(), ...ofQuantity.map((error) => error ?? 0));
    errorMap.draw({
      x: [...xs, "normal force [N]"], y: [...ys, "track curvature [1/m]"], bar: [0, most, "relative error [%]"],
      image: { nx, ny, x: xs, y: ys, value: (i, j) => 100 * errorAt(x(i), y(j)), draws: Number.isFinite },
      dots: data.checks.flatMap((check, k) => (ofQuantity[k] === null ? [] : [[check.fz, check.curvature, 100 * ofQuantity[k] / most]])),
    });
    errorMap.point(...middle);
    sayError(...middle);
    const colours = ["accent", "second", "third", "fourth"].map((name) => `var(--${name})`), axis = { title };
    const alongForce = few(data.curvature, 4).map((j, n) => {
      const curvature = curvatureAt(middleForce, data.curvature[j]);
      return { x: data.fz, y: data.fz.map((fz) => times * at(fz, curvature)), points: !data.flush && data.fz.length < 25, name: `${figure(curvature, data.flush ? 4 : 2)} 1/m`, colour: colours[n] };
    });
    const alongCurvature = few(data.fz, 4).map((i, n) => ({
      x: data.curvature.map((c) => curvatureAt(data.fz[i], c)), y: values[i].map((value) => times * value), points: data.curvature.length < 25, name: `${figure(data.fz[i], 3)} N`, colour: colours[n],
    }));
    overForce.draw({ x: { title: "normal force [N]" }, y: axis, series: alongForce });
    overCurvature.draw({ x: { title: "track curvature [1/m]" }, y: axis, series: alongCurvature });
    if (!space.works) return;
    const unitX = 2 / (xs[1] - xs[0]), unitY = 1.4 / (ys[1] - ys[0]), unitZ = 0.8 / (high - low || 1);
    const place = (i, j) => [(data.fz[i] - xs[0]) * unitX - 1, (curvatureAt(data.fz[i], data.curvature[j]) - ys[0]) * unitY - 0.7, (times * values[i][j] - low) * unitZ - 0.4];
    const [cx, cy] = [data.fz.length, data.curvature.length];
    space.draw({
      bodies: [surface(cx, cy, place, (i, j) => viridis((times * values[i][j] - low) / (high - low || 1)))],
      edges: boxEdges([-1, 1], [-0.7, 0.7], [-0.4, 0.4]),
      marks: [
        { at: [0, -0.86, -0.44], text: `Fz ${figure(xs[0], 3)} to ${figure(xs[1], 3)} N` },
        { at: [-1.22, 0, -0.46], text: `${figure(ys[0], 2)} to ${figure(ys[1], 2)} 1/m` },
        { at: [-1.16, 0.84, 0], text: `${figure(low, 3)} to ${figure(high, 3)} ${unit}` },
      ],
    });
  }
  draw();
}

/** Curvature [1/m] to what the second axis holds, and back, at a force [N]; the identity without `flush`. */
function reductionOf(flush) {
  if (!flush) return { reduced: (_, curvature) => curvature, curvatureAt: (_, place) => place };
  const [at, scale, from, to] = flush;
  const lengths = (fz) => [from, to].map((end) => Math.asinh((end - at) / (scale * fz)));
  return {
    reduced(fz, curvature) {
      const [low, high] = lengths(fz);
      return (Math.asinh((curvature - at) / (scale * fz)) - low) / (high - low);
    },
    curvatureAt(fz, place) {
      const [low, high] = lengths(fz);
      return place === 0 ? from : place === 1 ? to : at + scale * fz * Math.sinh(low + place * (high - low));
    },
  };
}

/** The ends of an axis; a single breakpoint gets some width. */
function span(values) {
  const [from, to] = [values[0], values[values.length - 1]];
  return to > from ? [from, to] : [from - (Math.abs(from) || 1) * 0.05, to + (Math.abs(to) || 1) * 0.05];
}

/** Values on the breakpoints as a function, bilinear, held at the ends. */
function between(xs, ys, values) {
  const cell = (nodes, value) => {
    if (nodes.length < 2) return [0, 0, 0];
    let k = nodes.findIndex((node) => node > value) - 1;
    if (k < 0) k = value < nodes[0] ? 0 : nodes.length - 2;
    return [k, k + 1, Math.min(Math.max((value - nodes[k]) / (nodes[k + 1] - nodes[k]), 0), 1)];
  };
  return (x, y) => {
    const [i, i1, s] = cell(xs, x), [j, j1, t] = cell(ys, y);
    return (1 - s) * ((1 - t) * values[i][j] + t * values[i][j1]) + s * ((1 - t) * values[i1][j] + t * values[i1][j1]);
  };
}

tablePage(document.getElementById("main"), pageData());
