// One solved contact: view, map, cuts, convergence and case.
//
// Data: the fields of ContactPage in kufe/src/report/contact.rs; `result` is result.json, a grid of `maps` holds the fields p, gap and uz
// packed over nx by ny points.

/** Below this part of the peak a place counts as outside the contact. */
const EDGE = 0.01;
/** So many figures are shown at once. */
const FIRST = 6;

/** Builds the page in `main`; the answer's `show(data)` fills it, again and again. */
function contactPage(main, between = null) {
  const head = el("header"), warnings = el("div"), headline = el("ul", { class: "figures" }), further = el("div");
  const view = contactView();
  const readout = el("output", { class: "readout", id: "readout" }, "");
  const part = el("select", { "aria-label": "part of the contact", onchange: () => choose(Number(part.value)) });
  const partLabel = el("label", {}, "part", part);
  let data = null, fields = null;
  const map = heatMap((x, y, pinned) => { say(x, y); if (pinned) cut(1e-3 * x, 1e-3 * y); });
  const charts = { along: chart(), alongHeight: chart(), across: chart(), acrossHeight: chart(), peak: chart() };
  const titles = { along: el("h2"), across: el("h2") };
  const history = el("div"), caseTable = el("div"), mounts = el("div");
  const mountsPanel = panel("What the runner pushes its mount with", mounts);
  main.replaceChildren(
    head, warnings, headline, el("details", {}, el("summary", {}, "Further figures"), further), ...(between ? [between] : []),
    el("div", { class: "panels" },
      panel("Hull, ice and pressure", view.box, view.tools),
      panel("Contact pressure", map.box, readout, el("div", { class: "tools" }, partLabel, el("span", {}, "Click or use the arrow keys to move the cuts."))),
      el("section", { class: "panel" }, titles.along, charts.along.box, charts.alongHeight.box),
      el("section", { class: "panel" }, titles.across, charts.across.box, charts.acrossHeight.box),
      mountsPanel,
      panel("Convergence", charts.peak.box, history),
      panel("The case", caseTable)),
  );

  function say(x, y) {
    const [p, gap] = [fields.p(1e-3 * x, 1e-3 * y), fields.gap(1e-3 * x, 1e-3 * y)];
    const place = `x ${at(x, fields.grid.dx * fields.grid.nx)} mm, y ${at(y, fields.grid.dy * fields.grid.ny)} mm: `;
    readout.textContent = p === null ? place + "outside the map"
      : `${place}${(1e-6 * p).toFixed(2)} MPa${p > 0 || gap === null ? "" : gap === Infinity ? ", no hull above" : `, gap ${metres(Math.max(gap, 0))}`}`;
  }

  /** A place [mm] with the digits that tell a thousandth of its axis' length [m]. */
  function at(mm, length) {
    const text = mm.toFixed(Math.min(9, Math.max(0, 3 - Math.floor(Math.log10(1e3 * length)))));
    return Number(text) === 0 ? "0" : text;
  }

  /** Cuts through a place [m]. */
  function cut(x, y) {
    const grid = fields.grid;
    const lines = (count, first, step, point) => {
      const where = Array.from({ length: count }, (_, k) => first + k * step);
      const of = (field, scale) => where.map((s) => { const value = field(...point(s)); return value === null ? NaN : scale * value; });
      return {
        mm: where.map((s) => 1e3 * s), p: of(fields.p, 1e-6), ice: of(fields.uz, 1e6),
        hull: where.map((s) => { const [g, u] = [fields.gap(...point(s)), fields.uz(...point(s))]; return g === null || !Number.isFinite(g) ? NaN : 1e6 * (g + u); }),
      };
    };
    const top = 1e-6 * fields.top;
    const pair = (pressure, heights, name, mark, cutLines) => {
      const x = { title: `${name} [mm]`, from: cutLines.mm[0], to: cutLines.mm[cutLines.mm.length - 1] };
      const marks = [{ x: mark }];
      pressure.draw({ x, y: { title: "p [MPa]", from: 0, to: 1.05 * top || 1 }, marks, height: 190, series: [{ x: cutLines.mm, y: cutLines.p, colour: "var(--accent)", fill: true }] });
      // The hull rises far above the deformed ice: it is clipped at the top, where the two are still distinguishable.
      const depth = Math.max(...cutLines.ice.map(Math.abs), 1e-6), highest = Math.max(...cutLines.hull.filter(Number.isFinite), ...cutLines.ice);
      heights.draw({
        x, y: { title: "height [\u00b5m]", to: highest > 2.5 * depth ? 2.5 * depth : undefined }, marks, height: 190,
        series: [
          { x: cutLines.mm, y: cutLines.ice, colour: "var(--third)", name: "ice" },
          { x: cutLines.mm, y: cutLines.hull, colour: "var(--steel)", name: "hull", dashed: true },
        ],
      });
    };
    titles.along.textContent = `Along the runner, at y = ${at(1e3 * y, grid.dy * grid.ny)} mm`;
    titles.across.textContent = `Across, at x = ${at(1e3 * x, grid.dx * grid.nx)} mm`;
    pair(charts.along, charts.alongHeight, "x", 1e3 * x, lines(grid.nx, grid.x0, grid.dx, (s) => [s, y]));
    pair(charts.across, charts.acrossHeight, "y", 1e3 * y, lines(grid.ny, grid.y0, grid.dy, (s) => [x, s]));
  }

  /** Shows one part of the contact. */
  function choose(number) {
    const grid = data.maps[number], p = unpack(grid.p), gap = unpack(grid.gap), uz = unpack(grid.uz);
    const top = p.reduce((best, value) => Math.max(best, value), 0), peak = middleOf(p, grid.nx, (1 - 1e-4) * top);
    fields = { grid, top, p: bilinear(grid, p), gap: bilinear(grid, gap), uz: bilinear(grid, uz) };
    const ends = (first, step, count) => [1e3 * (first - step / 2), 1e3 * (first + (count - 0.5) * step)];
    const [xs, ys] = [ends(grid.x0, grid.dx, grid.nx), ends(grid.y0, grid.dy, grid.ny)];
    map.draw({
      x: [...xs, "x along the runner [mm]"], y: [...ys, "y across [mm]"], bar: [0, 1e-6 * top, "contact pressure [MPa]"],
      image: { nx: grid.nx, ny: grid.ny, x: xs, y: ys, value: (i, j) => 1e-6 * p[j * grid.nx + i], draws: (value) => value > EDGE * 1e-6 * top },
    });
    const [x, y] = [grid.x0 + (peak % grid.nx) * grid.dx, grid.y0 + Math.floor(peak / grid.nx) * grid.dy];
    map.point(1e3 * x, 1e3 * y);
    say(1e3 * x, 1e3 * y);
    cut(x, y);
    view.show({ grid, p, gap, uz, top, hull: data.hull, result: data.result });
  }

  function show(next) {
    data = next;
    document.title = data.title;
    head.replaceChildren(el("h1", {}, data.title), el("p", { class: "soft" }, data.name));
    warnings.replaceChildren(...data.result.warnings.map((text) => el("p", { class: "warning" }, text)));
    headline.replaceChildren(...figures(data.figures.slice(0, FIRST).map(({ name, text, note }) => [text, note ? `${name}: ${note}` : name])));
    further.replaceChildren(table(["", "", ""], data.figures.slice(FIRST).map(({ name, text, note }) => [name, text, note])));
    partLabel.hidden = data.maps.length < 2;
    part.replaceChildren(...data.maps.map((grid, k) => el("option", { value: k }, `${k + 1}: x ${figure(1e3 * grid.x0, 3)} to ${figure(1e3 * (grid.x0 + grid.nx * grid.dx), 3)} mm`)));
    const highest = (grid) => grid.p.low + 65534 * grid.p.step;
    const first = data.maps.reduce((best, grid, k) => (highest(grid) > highest(data.maps[best]) ? k : best), 0);
    part.value = first;
    choose(first);
    convergence(data, charts, history);
    caseTable.replaceChildren(caseOf(data.result.case));
    mountsPanel.hidden = !data.result.mounts?.length;
    if (!mountsPanel.hidden) mounts.replaceChildren(...mountsOf(data.result.mounts));
  }
  return { show };
}

/** What each part of a mount bears. */
function mountsOf(mounts) {
  const said = (value) => figure(Math.abs(value) < 1e-6 ? 0 : value, 4);
  const row = (name, of) => [name, ...mounts.map((mount) => said(of(mount)))];
  const along = ["along", "across", "upwards"], about = ["x (roll)", "y (pitch)", "z (yaw)"];
  return [
    table(["middle at x [mm]", ...mounts.map((mount) => said(1e3 * mount.at_m[0]))], [
      ...along.map((name, k) => row(`force ${name} [N]`, (mount) => mount.force_n[k])),
      ...about.map((name, k) => row(`moment about ${name} [N m]`, (mount) => mount.moment_nm[k])),
      row("largest von Mises stress [MPa]", (mount) => 1e-6 * mount.von_mises_max_pa),
    ]),
    el("p", { class: "soft" }, "Moments are about the middle of each part of the mount. All is of the last mesh; at the rim of what is held the steel's stress grows with finer meshes."),
  ];
}

/** The meshes of a sliding contact, whose peak is the ice's hardness on each. */
function slidingMeshes(data, charts, history) {
  const meshes = data.result.sliding_history;
  charts.peak.draw({
    x: { title: "unknowns", log: true }, y: { title: "groove [\u00b5m]" }, height: 190,
    bands: [-1, 1].map((side) => 1e6 * (data.result.groove_depth_m + side * data.result.groove_depth_error_m)).reduce((low, high) => [{ low, high }]),
    series: [{ x: meshes.map((s) => s.dofs), y: meshes.map((s) => 1e6 * s.groove_depth_m), colour: "var(--accent)", points: true }],
  });
  history.replaceChildren(
    el("p", { class: "soft" }, "Depth of the groove on each mesh; the band is the stated error. The ice above is drawn without its groove: only what springs back. Below, the nodes that touch and how often the bodies corrected the plane's response."),
    table(["mesh", "unknowns", "touching", "corrections", "groove [\u00b5m]", "ploughing [N]"],
      meshes.map((s, k) => [String(k + 1), String(s.dofs), String(s.contact_nodes), String(s.corrections), (1e6 * s.groove_depth_m).toFixed(2), s.ploughing_by_work_n.toFixed(3)])));
}

/** Meshes in runs that grow: one that is graded anew begins with fewer unknowns. */
function gradingsOf(levels) {
  const runs = [];
  levels.forEach((mesh, k) => { if (k === 0 || mesh.dofs < levels[k - 1].dofs) runs.push([]); runs[runs.length - 1].push(mesh); });
  return runs;
}

function convergence(data, charts, history) {
  if (data.result.sliding_history?.length) { slidingMeshes(data, charts, history); return; }
  const last = [];
  for (const state of data.result.history) last[state.level] = state;
  const levels = last.filter(Boolean), result = data.result, error = result.p_max_error_pa ?? 0;
  charts.peak.draw({
    x: { title: "unknowns", log: true }, y: { title: "peak [MPa]" }, height: 190,
    bands: [{ low: 1e-6 * (result.p_max_pa - error), high: 1e-6 * (result.p_max_pa + error) }],
    series: gradingsOf(levels).map((meshes) => ({ x: meshes.map((s) => s.dofs), y: meshes.map((s) => 1e-6 * s.p_max_pa), colour: "var(--accent)", points: true })),
  });
  history.replaceChildren(
    el("p", { class: "soft" }, "Peak pressure on each mesh; the band is the extrapolated peak with its estimated error. Below, what the solver did on each: nodes that touch, projected sweeps that find them, solves on the set that they found (accepted when the energy falls), and iterations of these."),
    table(["mesh", "unknowns", "touching", "sweeps", "solves", "iterations", "energy [mJ]", "peak [MPa]"],
      data.result.history.map((s) => [String(s.level + 1), String(s.dofs), String(s.contact_nodes), String(s.sweeps ?? "-"), String(s.accelerations ?? "-"), String(s.iterations), figure(1e3 * s.energy_j), (1e-6 * s.p_max_pa).toFixed(2)])));
}

/** The place of a plateau's middle: the point at or above `least` that is nearest to the mean of them all. */
function middleOf(values, columns, least) {
  const high = [];
  values.forEach((value, k) => { if (value >= least) high.push(k); });
  const mean = (of) => high.reduce((sum, k) => sum + of(k), 0) / high.length;
  const [i, j] = [mean((k) => k % columns), mean((k) => Math.floor(k / columns))];
  const far = (k) => Math.hypot((k % columns) - i, Math.floor(k / columns) - j);
  return high.reduce((best, k) => (far(k) < far(best) ? k : best), high[0]);
}

/** The view in space, of the contact or of the whole runner. */
function contactView() {
  const space = stage("hull, ice and pressure in space; drag to turn, scroll to come closer");
  const which = el("select", { "aria-label": "what is shown", onchange: () => draw() }, el("option", { value: "contact" }, "the contact"), el("option", { value: "whole" }, "the whole runner"));
  const hull = el("input", { type: "checkbox", checked: true, onchange: () => draw() });
  const lift = el("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0.5, "aria-label": "lift the hull", oninput: () => draw() });
  const note = el("span");
  const tools = el("div", { class: "tools" }, el("label", {}, "show", which), el("label", {}, hull, "hull"), el("label", {}, "lifted", lift),
    el("button", { class: "button", type: "button", onclick: () => space.reset() }, "reset"), note);
  if (!space.works) tools.hidden = true;
  let data = null;
  function draw() {
    if (!data || !space.works) return;
    const whole = which.value === "whole" && data.hull;
    const spec = (whole ? wholeSpec : nearSpec)(data, hull.checked, Number(lift.value));
    note.textContent = spec.note;
    space.draw(spec);
  }
  return {
    box: space.box, tools,
    show(next) { data = next; which.disabled = !data.hull; if (!data.hull) which.value = "contact"; draw(); },
  };
}

/**
 * Where a contact ends between the points of a grid, for `surface`: inside is what touches, or with `beyond` what does not.
 *
 * Near its rim the square of a contact's pressure falls in proportion to the distance from it, so the last two points that touch tell where it is.
 */
function rimOf({ p, top }, at, beyond = false) {
  const touches = (i, j) => p[at(i, j)] > EDGE * top;
  const share = ([i, j], [k, l]) => {
    const last = p[at(i, j)] ** 2, before = p[at(2 * i - k, 2 * j - l)] ** 2;
    return before > last ? Math.min(1, (last - (EDGE * top) ** 2) / (before - last)) : 1;
  };
  return beyond ? { inside: (i, j) => !touches(i, j), share: (a, b) => 1 - share(b, a) } : { inside: touches, share };
}

/** Where a height passes a ceiling, for `surface`; a place without a height has nothing on the way to it. */
const heightRim = (height, ceiling) => ({
  inside: (i, j) => height(i, j) <= ceiling,
  share: ([i, j], [k, l]) => (Number.isFinite(height(k, l)) ? (ceiling - height(i, j)) / (height(k, l) - height(i, j)) : null),
});

function nearSpec(data, withHull, lift) {
  const { grid, p, top, gap, uz } = data, every = (count, most) => Math.max(1, Math.ceil(count / most));
  const [ei, ej] = [every(grid.nx, 150), every(grid.ny, 90)], nx = Math.ceil(grid.nx / ei), ny = Math.ceil(grid.ny / ej);
  const size = [(grid.nx - 1) * grid.dx, (grid.ny - 1) * grid.dy];
  let low = Infinity, high = -Infinity, hullTop = -Infinity;
  uz.forEach((value, k) => {
    low = Math.min(low, value);
    high = Math.max(high, value);
    if (Number.isFinite(gap[k])) hullTop = Math.max(hullTop, value + gap[k]);
  });
  const ceiling = Math.max(high, Math.min(hullTop, high + 3 * (high - low)));
  const unit = [2.2 / size[0], 1.2 / size[1], 0.62 / (ceiling - low || 1)];
  const place = (i, j, z) => [(i * ei * grid.dx - size[0] / 2) * unit[0], (j * ej * grid.dy - size[1] / 2) * unit[1], (z - low) * unit[2] - 0.4];
  const at = (i, j) => j * ej * grid.nx + i * ei, onIce = (i, j) => place(i, j, uz[at(i, j)]);
  const ice = surface(nx, ny, onIce, () => rgbOf("ice"), rimOf(data, at, true));
  const patch = surface(nx, ny, onIce, (i, j) => viridis(p[at(i, j)] / (top || 1)), rimOf(data, at));
  // The hull ends where it is too high to be shown with the ice.
  const height = (i, j) => uz[at(i, j)] + gap[at(i, j)];
  const under = surface(nx, ny, (i, j) => place(i, j, Number.isFinite(height(i, j)) ? height(i, j) : ceiling), null, heightRim(height, ceiling));
  const [x, y, z] = [[-1.1, 1.1], [-0.6, 0.6], [-0.4, 0.22]];
  const times = (value) => `${figure(value, 2)}\u00d7`;
  return {
    bodies: [ice, patch, ...(withHull ? [{ ...under, colour: "steel", opacity: 0.55, lift: 0.6 * lift }] : [])],
    edges: boxEdges(x, y, z),
    marks: [
      { at: [0, -0.74, -0.42], text: `x ${metres(size[0])}` }, { at: [1.26, 0, -0.42], text: `y ${metres(size[1])}` },
      { at: [-1.3, -0.66, -0.09], text: `z ${metres(ceiling - low)}` },
    ],
    note: `Against x, y is stretched ${times(unit[1] / unit[0])} and z ${times(unit[2] / unit[0])}.`,
  };
}

function wholeSpec(data, withHull, lift) {
  const { grid, hull } = data, [xs, ys, zs] = [unpack(hull.x), unpack(hull.y), unpack(hull.z)];
  const range = (values) => values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
  const [xr, yr, zr] = [range(xs), range(ys), range(zs)], wide = 1.6 * (yr[1] - yr[0]);
  const unit = [2.2 / (xr[1] - xr[0]), 0.8 / wide, 0.5 / Math.max(zr[1] - Math.min(zr[0], 0), 1e-9)];
  const middle = [(xr[0] + xr[1]) / 2, (yr[0] + yr[1]) / 2];
  const place = (x, y, z) => [(x - middle[0]) * unit[0], (y - middle[1]) * unit[1], z * unit[2] - 0.3];
  const positions = new Float32Array(3 * xs.length);
  xs.forEach((x, k) => positions.set(place(x, ys[k], Math.max(zs[k], 0)), 3 * k));
  const ice = surface(2, 2, (i, j) => place(xr[i], middle[1] + (j - 0.5) * wide, 0), () => rgbOf("ice"));
  const every = Math.max(1, Math.ceil(grid.nx / 100)), nx = Math.ceil(grid.nx / every), at = (i, j) => j * grid.nx + i * every;
  // A little above the ice, that both are not drawn into one another.
  const onIce = (i, j) => { const [px, py, pz] = place(grid.x0 + i * every * grid.dx, grid.y0 + j * grid.dy, 0); return [px, py, pz + 0.003]; };
  const patch = surface(nx, grid.ny, onIce, (i, j) => viridis(data.p[at(i, j)] / (data.top || 1)), rimOf(data, at));
  const times = (value) => `${figure(value, 2)}\u00d7`;
  return {
    bodies: [ice, patch, ...(withHull ? [{ positions, index: hull.triangles.flat(), colour: "steel", opacity: 0.8, lift: 0.5 * lift }] : [])],
    edges: boxEdges([-1.1, 1.1], [-0.4, 0.4], [-0.3, 0.2]),
    marks: [
      { at: [0, -0.55, -0.32], text: `x ${metres(xr[1] - xr[0])}` }, { at: [1.24, 0, -0.32], text: `y ${metres(wide)}` },
      { at: [-1.3, -0.46, -0.05], text: `z ${metres(0.5 / unit[2])}` },
    ],
    note: `Against x, y is stretched ${times(unit[1] / unit[0])} and z ${times(unit[2] / unit[0])}.`,
  };
}
