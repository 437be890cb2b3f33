// The page of `kufe view`: a form over the page of one contact, which solves again while it is moved.
//
// Data: those of contact.js, `case_text`, `form`: { shape: bob, luge or none, and the form's values } and `ranges`: { name: [from, to] }. The
// server answers POST /solve with the data of the new contact and its case as text; an answer that a newer question has overtaken is left.

const FIELDS = [
  // name, label, unit, logarithmic, shown as, of which runners
  ["rocker_radius_m", "rocker radius", "m", true, (v) => figure(v, 3), ["bob", "luge"]],
  ["section_radius_m", "section radius", "mm", true, (v) => figure(1e3 * v, 3), ["bob"]],
  ["edge_radius_m", "edge radius", "mm", true, (v) => figure(1e3 * v, 3), ["luge"]],
  ["tilt_rad", "tilt about x", "mrad", false, (v) => figure(1e3 * v, 3), ["bob", "luge", "none"]],
  ["fz_n", "normal force", "N", true, (v) => figure(v, 3), ["bob", "luge", "none"]],
  ["curvature_1pm", "track radius", "m", false, (v) => (Math.abs(v) < 5e-5 ? "straight" : figure(1 / v, 3)), ["bob", "luge", "none"]],
  ["offset_x_m", "load ahead of the origin", "mm", false, (v) => figure(1e3 * v, 3), ["bob", "luge", "none"]],
  ["hardness_pa", "hardness of the ice", "MPa", true, (v) => (v > 0.999e9 ? "none" : figure(1e-6 * v, 3)), ["bob", "luge", "none"]],
];
/** Texts of values without a unit. */
const WORDS = ["straight", "none"];

function viewPage(main, first) {
  const form = { ...first.form }, state = el("p", { class: "state", role: "status" }, "");
  const kind = el("select", { id: "kind", onchange: () => { form.shape = kind.value; build(); ask(); } }, el("option", { value: "bob" }, "bobsled runner"), el("option", { value: "luge" }, "luge steel"));
  const box = el("div", { class: "form" });
  const save = el("button", { class: "button", type: "button", onclick: () => download() }, "save as case.toml");
  const fixed = form.shape === "none";
  const section = el("section", { class: "panel sliders" },
    el("div", { class: "tools", style: "margin:0 0 .6rem" }, el("label", { hidden: fixed }, "runner", kind), save), box, state);
  const page = contactPage(main, section);
  let text = first.case_text, waiting = null;

  function build() {
    kind.value = form.shape;
    box.replaceChildren(...FIELDS.filter((field) => field[5].includes(form.shape)).map(([name, label, unit, log, shown]) => {
      const [from, to] = first.ranges[name];
      const value = el("b"), say = () => { const text = shown(form[name]); value.textContent = WORDS.includes(text) ? text : `${text} ${unit}`; };
      const place = (v) => 1000 * (log ? Math.log(v / from) / Math.log(to / from) : (v - from) / (to - from));
      const input = el("input", { type: "range", name, min: 0, max: 1000, step: 1, oninput: () => {
        const t = Number(input.value) / 1000;
        form[name] = log ? from * (to / from) ** t : from + (to - from) * t;
        if (!log && Math.abs(form[name]) < (to - from) * 2e-3) form[name] = 0;
        say();
        ask();
      } });
      input.value = place(form[name]);
      say();
      return el("label", {}, value, label, input);
    }));
  }
  async function ask() {
    waiting?.abort();
    const mine = (waiting = new AbortController());
    state.className = "state";
    state.textContent = "solving ...";
    try {
      const answer = await fetch("/solve", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(form), signal: mine.signal });
      const found = await answer.json();
      if (mine !== waiting) return;
      if (!answer.ok) throw new Error(found.error);
      text = found.case_text;
      page.show(found);
      state.textContent = `solved in ${figure(found.result.seconds, 2)} s`;
    } catch (error) {
      if (mine !== waiting || error.name === "AbortError") return;
      state.className = "state bad";
      state.textContent = error instanceof TypeError ? "kufe view does not answer: is it still running?" : error.message;
    }
  }
  function download() {
    const link = el("a", { href: URL.createObjectURL(new Blob([text], { type: "application/toml" })), download: "case.toml" });
    link.click();
    URL.revokeObjectURL(link.href);
  }
  build();
  page.show(first);
}

viewPage(document.getElementById("main"), pageData());
