// Header, run bar, list of runs and regime: which of them `model.part` says. Texts are only set as text.

function make(tag, properties = {}, ...children) {
  const { aria, ...rest } = properties;
  const node = Object.assign(document.createElement(tag), rest);
  for (const [key, value] of Object.entries(aria ?? {})) node.setAttribute(`aria-${key}`, value);
  node.append(...children.filter((child) => child != null));
  return node;
}

// What is typed is sent when typing pauses, or now.
function send_typed() {
  let at = document.activeElement;
  while (at?.shadowRoot) at = at.shadowRoot.activeElement;
  if (at?.type === "text") at.dispatchEvent(new Event("change"));
}

// What the page fills: the whole window, or its cell of a notebook.
function frame(el) {
  let node = el;
  while (node.getRootNode() instanceof ShadowRoot) node = node.getRootNode().host;
  return node.classList.contains("softafm-cell") ? node : document.documentElement;
}

const parts = {
  header({ model, el, send, view }) {
    const theme = make("button", { className: "theme", type: "button" });
    const apply = (name, told) => {
      theme.textContent = name === "dark" ? "light" : "dark";
      theme.setAttribute("aria-label", `switch to ${theme.textContent} colours`);
      frame(el).dataset.softafm = name;
      if (told) send({ theme: name });
    };
    theme.addEventListener("click", () => {
      const wanted = frame(el).dataset.softafm === "dark" ? "light" : "dark";
      try { localStorage.setItem("softafm-theme", wanted); } catch { /* it is only for comfort */ }
      apply(wanted, true);
    });
    const file = make("input", { type: "file", accept: ".toml,.nc", className: "unseen open" });
    file.addEventListener("change", async () => {
      const [given] = file.files;
      if (given === undefined) return;
      const bytes = new Uint8Array(await given.slice(0, model.state.largest + 1).arrayBuffer());
      const chunks = [];
      for (let at = 0; at < bytes.length; at += 0x8000)
        chunks.push(String.fromCharCode(...bytes.subarray(at, at + 0x8000)));
      send({ open: given.name, content: btoa(chunks.join("")) });
      file.value = "";
    });
    const reload = make("button", { type: "button" }, "reload the page");
    reload.addEventListener("click", () => location.reload());
    const lost = make("p", { className: "bar lost", hidden: true }, "The server cannot be reached. "
      + "The form is kept in the address of this page, the runs are not.", reload);
    lost.setAttribute("role", "alert");
    el.append(make("div", { className: "bar header" }, make("h1", {}, "softafm"),
      make("span", { className: "about" }, "atomic force microscopy on soft, sticky, viscoelastic surfaces"),
      make("span", { className: "space" }),
      make("label", { className: "button", title: "an experiment (.toml) or a result (.nc)" },
        "open a file", file),
      theme), lost);
    view.model.document?.on_event("connection_lost", () => { lost.hidden = false; });
    let kept = null;
    try { kept = localStorage.getItem("softafm-theme"); } catch { /* as above */ }
    const light = document.body.dataset.jpThemeLight; // told by Jupyter alone
    const dark = light ? light === "false"
      : window.matchMedia("(prefers-color-scheme: dark)").matches;
    apply(kept ?? (dark ? "dark" : "light"), true);
    frame(el).dataset.lmSuppressShortcuts = "true"; // Jupyter's, for keys pressed in the page
    return () => {};
  },

  bar({ model, el, send }) {
    const run = make("button", { className: "run", type: "button", title: "Ctrl + Enter" }, "Run");
    const movie = make("input", { type: "checkbox", className: "movie", id: "softafm-movie" });
    const words = make("p", { className: "words" });
    words.setAttribute("role", "status");
    run.addEventListener("click", () => send({ run: true }));
    movie.addEventListener("change", () => send({ movie: movie.checked }));
    document.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || event.repeat || !(event.ctrlKey || event.metaKey)) return;
      if (!event.composedPath().includes(frame(el))) return;
      send_typed();
      send({ run: true });
    });
    el.append(make("div", { className: "run-bar" },
      make("div", { className: "bar" }, run,
        make("label", { htmlFor: "softafm-movie", className: "bar" }, movie, "with surface movie")),
      words));
    return () => {
      const { state } = model;
      run.disabled = !state.can_run;
      movie.checked = state.movie;
      movie.disabled = !state.can_film;
      words.textContent = state.words;
      words.classList.toggle("bad", state.bad);
    };
  },

  regime({ model, el }) {
    const caption = make("caption");
    const body = make("tbody");
    el.append(make("table", {}, caption, body));
    return () => {
      const { state } = model;
      caption.textContent = state.caption;
      body.replaceChildren(...state.rows.map((row) => make("tr", {}, ...row.map((text, column) =>
        make("td", { className: state.bad && column === 1 ? "problem" : "" }, text)))));
    };
  },

  list({ model, el, send }) {
    const list = make("ul", { className: "runs", aria: { label: "runs" } });
    const none = make("p", { className: "none" }, "No runs yet. Choose a preset or fill in the form, then run.");
    el.append(none, list);
    const rows = new Map();

    function row(id) {
      const shown = make("input", { type: "checkbox", className: "shown", aria: { label: "draw it" } });
      const label = make("input", { type: "text", className: "label", maxLength: 60, spellcheck: false,
        aria: { label: "name of the run" } });
      const dot = make("span", { className: "dot", aria: { hidden: "true" } });
      const state = make("span", { className: "state" });
      const bar = make("progress", { max: 1 });
      const end = make("button", { type: "button", className: "end" });
      const node = make("li", {}, shown, dot, label, bar, state, end);
      shown.addEventListener("change", () => send({ show: id, shown: shown.checked }));
      label.addEventListener("change", () => send({ rename: id, label: label.value }));
      label.addEventListener("focus", () => send({ select: id }));
      end.addEventListener("click", () => send({ end: id }));
      node.addEventListener("click", (event) => {
        if (event.target === node || event.target === state) send({ select: id });
      });
      return { node, shown, label, dot, state, bar, end };
    }

    return () => {
      const { runs, selected } = model.state;
      none.hidden = runs.length > 0;
      for (const [id, { node }] of [...rows])
        if (!runs.some((run) => run.id === id)) { node.remove(); rows.delete(id); }
      for (const run of runs) {
        if (!rows.has(run.id)) { rows.set(run.id, row(run.id)); list.append(rows.get(run.id).node); }
        const { node, shown, label, dot, state, bar, end } = rows.get(run.id);
        node.className = `run-${run.state}${run.id === selected ? " selected" : ""}`;
        node.setAttribute("aria-current", String(run.id === selected));
        shown.checked = run.shown;
        shown.disabled = run.state !== "done";
        dot.style.background = run.colour;
        if (el.getRootNode().activeElement !== label) label.value = run.label;
        bar.hidden = run.state !== "running";
        bar.value = run.fraction;
        state.textContent = run.words;
        state.title = run.words;
        state.classList.toggle("problem", run.bad);
        end.textContent = ["waiting", "running"].includes(run.state) ? "cancel" : "remove";
        end.setAttribute("aria-label", `${end.textContent} ${run.label}`);
      }
    };
  },
};

export function render({ model, el, view }) {
  const follow = parts[model.part]({ model, el, view, send: (message) => model.send_msg(message) });
  model.on("state", follow);
  follow();
}
