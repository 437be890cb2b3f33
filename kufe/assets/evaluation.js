// The page of an evaluation of drivers.
//
// Data: evaluation.json: { runs: [one a run], groups: [{ by, name, track, runs, increase_*: { mean, low, high } }], drivers: [{ driver, track, runs, lost_s, stretches: [{ from_m, to_m, front_j, rear_j, aero_j, lost_s }] }], interval, left_out, tables: [{ runner, picture }],
// viewer: address of the page of the runs }.

const PARTS = [["increase_front", "front runner", "--accent"], ["increase_rear", "rear runner", "--second"], ["increase_aero", "air", "--third"]];

function evaluationPage(main, data) {
  const tracks = [...new Set(data.runs.map((run) => run.track))], classes = [...new Set(data.runs.map((run) => run.driver_class))];
  const box = el("div"), where = el("select", { id: "where", onchange: () => draw() });
  const places = [null, ...(tracks.length > 1 ? tracks : [])];
  where.append(...places.map((track, k) => el("option", { value: k }, track ?? "every track")));
  const by = el("select", { id: "by", onchange: () => draw() }, ["driver", "class", "track"].filter((name) => data.groups.some((group) => group.by === name)).map((name) => el("option", { value: name }, name)));
  const best = data.groups.filter((group) => group.by === "driver" && !group.track).sort((a, b) => a.increase_total.mean - b.increase_total.mean);
  main.replaceChildren(
    el("header", {}, el("h1", {}, "What drivers lose"),
      el("p", { class: "soft" }, "Energy lost beyond a straight glide of the same sled, relative to the glide's own loss. Smaller is better.")),
    el("ul", { class: "figures" }, figures([
      [String(data.runs.length), "runs"], [String(tracks.length), tracks.length === 1 ? "track" : "tracks"],
      [String(new Set(data.runs.map((run) => run.driver)).size), `drivers in ${classes.length} ${classes.length === 1 ? "class" : "classes"}`],
      ...(best.length ? [[best[0].name, `least, ${percent(best[0].increase_total.mean)}`]] : []),
      ...(best.length > 1 ? [[best[best.length - 1].name, `most, ${percent(best[best.length - 1].increase_total.mean)}`]] : []),
    ])),
    ...(data.left_out?.length ? [el("p", { class: "warning" }, `Left out: ${data.left_out.map((item) => (typeof item === "string" ? item : JSON.stringify(item))).join("; ")}`)] : []),
    el("div", { class: "tools", style: "margin-bottom:.8rem" }, el("label", {}, "by", by), el("label", { hidden: places.length < 2 }, "on", where)),
    el("div", { class: "panels" },
      el("section", { class: "panel wide" }, el("h2", {}, "Loss beyond a straight glide"), box, el("p", { class: "soft" }, `Bars: mean by part. Line: interval of the total (${data.interval ?? "as evaluated"}). Rings: single runs.`)),
      ...(data.drivers?.length ? [losses(data, tracks)] : []),
      ...(data.tables ?? []).map(({ runner, picture }) => el("section", { class: "panel wide" }, el("h2", {}, `Where the ${runner} asks its table of friction`),
        el("label", { class: "picture", title: "a click shows it at full size" }, el("input", { type: "checkbox" }), el("img", { alt: `samples of the ${runner} upon its table`, src: picture })))),
      el("section", { class: "panel wide" }, el("h2", {}, "Every run"), runTable(data.runs, data.viewer))),
  );
  let width = 0;
  function draw() {
    if (width === 0) return;
    const place = places[where.value], key = { driver: "driver", class: "driver_class", track: "track" }[by.value];
    const groups = data.groups.filter((group) => group.by === by.value && (by.value === "track" || (group.track ?? null) === place));
    const runsOf = (group) => data.runs.filter((run) => run[key] === group.name && (!place || run.track === place));
    box.replaceChildren(bars(groups, runsOf, width));
  }
  new ResizeObserver(([entry]) => { width = Math.round(entry.contentRect.width); requestAnimationFrame(draw); }).observe(box);
}

/** A link to runs in the page of the runs, from and to a distance where they are stated. */
function viewed(viewer, text, runs, stretch = {}) {
  const part = new URLSearchParams([...runs.map((run) => ["run", run]), ...Object.entries(stretch)]);
  return el("a", { href: `${viewer}#${part}` }, text);
}

/** The time that two drivers lose along a track, and where they differ most. */
function losses({ drivers, runs, viewer }, tracks) {
  const here = () => drivers.filter((one) => one.track === track.value), picked = (list) => here().find((one) => one.driver === list.value);
  const option = (name) => el("option", { value: name }, name);
  const track = el("select", { onchange: () => fill() }, tracks.map(option)), lists = [0, 1].map(() => el("select", { onchange: () => draw() }));
  const [by, sum] = [chart(), chart()], differences = el("div");
  function fill() {
    // The one who loses least, and the one who loses most.
    const sorted = here().sort((a, b) => a.lost_s - b.lost_s);
    lists.forEach((list, k) => { list.replaceChildren(...sorted.map((one) => option(one.driver))); list.value = sorted[k === 0 ? 0 : sorted.length - 1].driver; });
    draw();
  }
  function draw() {
    const pair = [...new Set(lists.map(picked))], colours = ["var(--accent)", "var(--second)"];
    const line = (x, y) => pair.map((one, k) => ({ ...one, name: `${one.driver} (${one.runs})`, colour: colours[k], x: x(one), y: y(one) }));
    const total = (one) => one.stretches.reduce((sums, { lost_s: lost }) => [...sums, (sums[sums.length - 1] ?? 0) + lost], []);
    const x = { title: "distance [m]" };
    by.draw({ x, y: { title: "lost on 25 m [s]" }, series: line((one) => one.stretches.flatMap((s) => [s.from_m, s.to_m]), (one) => one.stretches.flatMap((s) => [s.lost_s, s.lost_s])) });
    sum.draw({ x, y: { title: "lost so far [s]" }, series: line((one) => one.stretches.map((s) => s.to_m), total) });
    if (pair.length < 2) { differences.replaceChildren(); return; }
    const [a, b] = pair, other = new Map(a.stretches.map((stretch) => [stretch.from_m, stretch]));
    const rows = b.stretches.filter((s) => other.has(s.from_m)).map((s) => [s, other.get(s.from_m)]).sort(([p, q], [r, t]) => Math.abs(r.lost_s - t.lost_s) - Math.abs(p.lost_s - q.lost_s));
    // The quickest run of each driver.
    const quickest = ({ driver }) => runs.filter((run) => run.driver === driver && run.track === track.value).sort((p, q) => p.time_s - q.time_s)[0]?.run;
    const names = viewer ? [quickest(a), quickest(b)].filter(Boolean) : [];
    const links = ({ from_m: from, to_m: to }) => (names.length === 2 ? [viewed(viewer, names.join(", "), names, { from: from - 25, to: to + 25 })] : []);
    differences.replaceChildren(table(["from [m]", "to [m]", `${a.driver} [s]`, `${b.driver} [s]`, "difference [s]", "energy [J]", ...(names.length === 2 ? ["in the viewer"] : [])], rows.slice(0, 5).map(([s, t]) => [
      s.from_m.toFixed(0), s.to_m.toFixed(0), t.lost_s.toFixed(4), s.lost_s.toFixed(4), (s.lost_s - t.lost_s).toFixed(4), ["front_j", "rear_j", "aero_j"].reduce((energy, key) => energy + s[key] - t[key], 0).toFixed(1), ...links(s)])));
  }
  const box = el("section", { class: "panel wide" }, el("h2", {}, "Where the time goes"), el("div", { class: "tools" }, el("label", { hidden: tracks.length < 2 }, "on", track), lists.map((list) => el("label", {}, list))), by.box, sum.box, differences,
    el("p", { class: "soft" }, "Energy lost over a straight glide, by the time that it delays the end of the run: the slower sled has less drag. Means of runs, in brackets their number."));
  fill();
  return box;
}

const percent = (share) => `${figure(100 * share, 3)} %`;

/** Stacked bars, one a group, each with its runs as rings. */
function bars(groups, runsOf, width) {
  const [left, right, row, top] = [Math.min(150, width * 0.3), 80, 34, 8], height = top + row * groups.length + 44;
  const ends = groups.flatMap((group) => [group.increase_total.mean, group.increase_total.high ?? 0, ...runsOf(group).map((run) => run.increase_total)]);
  const starts = groups.flatMap((group) => [0, group.increase_total.low ?? 0, ...runsOf(group).map((run) => run.increase_total), ...PARTS.map(([key]) => group[key].mean)]);
  const low = 100 * Math.min(...starts), high = 100 * Math.max(...ends, 1e-6);
  const x = (value) => left + (width - left - right) * (value - low) / (high - low);
  const root = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": "loss increase by group" });
  const marks = ticks(low, high, Math.max(2, width / 120));
  tickTexts(marks).forEach((text, k) => {
    root.append(svg("line", { x1: x(marks[k]), x2: x(marks[k]), y1: top, y2: height - 44, stroke: "var(--grid)" }));
    root.append(svg("text", { x: x(marks[k]), y: height - 26, "text-anchor": "middle" }, text));
  });
  root.append(svg("text", { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle" }, "loss beyond a straight glide [%]"));
  groups.forEach((group, k) => {
    const y = top + row * k + 6, total = group.increase_total;
    root.append(svg("text", { x: left - 8, y: y + 15, "text-anchor": "end", class: "name" }, `${group.name} (${group.runs})`));
    let [up, down] = [0, 0];
    for (const [key, , colour] of PARTS) {
      const share = 100 * group[key].mean, from = share >= 0 ? up : down + share;
      root.append(svg("rect", { x: x(from), y, width: Math.max(0, x(from + Math.abs(share)) - x(from)), height: 20, fill: `var(${colour})`, opacity: 0.85 }));
      if (share >= 0) up += share; else down += share;
    }
    for (const run of runsOf(group)) {
      root.append(svg("circle", { cx: x(100 * run.increase_total), cy: y + 10, r: 3.5, fill: "none", stroke: "var(--ink)", opacity: 0.6 }, svg("title", {}, `${run.run}: ${percent(run.increase_total)}`)));
    }
    if (total.low !== null && total.low !== undefined) root.append(svg("line", { x1: x(100 * total.low), x2: x(100 * total.high), y1: y + 10, y2: y + 10, stroke: "var(--ink)", "stroke-width": 2 }));
    root.append(svg("text", { x: width - right + 8, y: y + 15, class: "name" }, percent(total.mean)));
  });
  const swatch = (colour) => svg("svg", { width: 12, height: 12 }, svg("rect", { width: 12, height: 12, fill: `var(${colour})` }));
  return el("div", { class: "chart" }, el("div", { class: "legend" }, PARTS.map(([, name, colour]) => el("span", {}, swatch(colour), name))), root);
}

/** Runs as rows, sorted by the column whose head is clicked; their names are links where there is a page of the runs. */
function runTable(runs, viewer) {
  const columns = [
    ["run", (run) => run.run], ["track", (run) => run.track], ["driver", (run) => run.driver], ["class", (run) => run.driver_class], ["session", (run) => run.session],
    ["time [s]", (run) => run.time_s, 2], ["glide's loss [kJ]", (run) => -1e-3 * run.e_tot_loss_j, 1],
    ...PARTS.map(([key, name]) => [`${name} [%]`, (run) => 100 * run[key], 2]), ["total [%]", (run) => 100 * run.increase_total, 2],
    ["steering above 2\u00b0 [%]", (run) => 100 * run.steering.share_above_2deg, 1], ["front slip above 2\u00b0 [%]", (run) => 100 * run.slip_front.share_above_2deg, 1],
  ];
  const body = el("tbody");
  let sorted = null, sense = 1;
  function fill() {
    const rows = [...runs];
    if (sorted !== null) {
      const of = columns[sorted][1];
      rows.sort((a, b) => sense * (typeof of(a) === "number" ? of(a) - of(b) : String(of(a)).localeCompare(String(of(b)))));
    }
    body.replaceChildren(...rows.map((run) => el("tr", {}, columns.map(([name, of, digits]) => (digits === undefined ? el("td", {}, viewer && name === "run" ? viewed(viewer, run.run, [run.run]) : of(run)) : el("td", { class: "n" }, of(run).toFixed(digits)))))));
  }
  const head = el("tr", {}, columns.map(([name, , digits], k) => el("th", { class: digits === undefined ? null : "n" },
    el("button", { type: "button", onclick: () => { sense = sorted === k ? -sense : 1; sorted = k; fill(); } }, name))));
  fill();
  return el("div", { class: "scroll" }, el("table", {}, el("thead", {}, head), body));
}

evaluationPage(document.getElementById("main"), pageData());
