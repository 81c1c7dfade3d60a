// Draws the form that `model.plan` describes, fills it with `model.state`, and sends what is
// answered. Texts from the document are only ever set as text, never as HTML.

const PAUSE = 150; // ms without a key after which a text is sent

function make(tag, properties = {}, ...children) {
  const { data, aria, ...rest } = properties;
  const node = Object.assign(document.createElement(tag), rest);
  for (const [key, value] of Object.entries(data ?? {})) node.dataset[key] = value;
  for (const [key, value] of Object.entries(aria ?? {})) node.setAttribute(`aria-${key}`, value);
  node.append(...children.filter((child) => child != null));
  return node;
}

function options(select, pairs) {
  select.replaceChildren(...pairs.map(([value, text]) => make("option", { value }, text)));
}

export function render({ model, el }) {
  const send = (message) => model.send_msg(message);
  const sections = new Map(); // by path: what is drawn, and as what
  const strip = make("div", { className: "help-strip", aria: { hidden: "true" } });
  const elsewhere = make("ul", { className: "elsewhere" });
  const basics = make("div", { className: "basics" });
  const advanced = make("details", { className: "advanced" });
  const changed = make("span", { className: "changed" });
  advanced.append(make("summary", {}, "solver and run", changed));
  const preset = chooser("preset", "preset");
  const mode = chooser("mode", "mode");
  el.append(make("div", { className: "softafm-form" }, preset.row, mode.row, elsewhere, basics,
    advanced, strip));

  function chooser(path, label) {
    const id = `choice-${path}`;
    const select = make("select", { id, className: id, aria: { describedby: `${id}-problem` } });
    select.addEventListener("change", () => send({ choose: path, choice: select.value }));
    const row = make("div", { className: "row", data: { path } },
      make("label", { htmlFor: id }, label), select, problem(id));
    return { row, select };
  }

  function problem(id) {
    return make("p", { className: "problem", id: `${id}-problem`, hidden: true });
  }

  // A text is sent when typing pauses, and at once when the field is left.
  function text(field, id) {
    const input = make("input", { id, type: "text", autocomplete: "off", spellcheck: false,
      data: { example: field.example }, aria: { describedby: `${id}-help ${id}-problem` } });
    const flush = () => {
      if (input.timer === undefined) return;
      clearTimeout(input.timer);
      input.timer = undefined;
      input.sent = input.value;
      send({ edit: field.path, text: input.value });
    };
    input.addEventListener("input", () => {
      clearTimeout(input.timer);
      input.timer = setTimeout(flush, PAUSE);
    });
    input.addEventListener("change", flush);
    input.addEventListener("blur", flush);
    return input;
  }

  function flag(field, id) {
    const input = make("input", { id, type: "checkbox", aria: { describedby: `${id}-help` } });
    input.addEventListener("change", () => send({ edit: field.path, text: String(input.checked) }));
    return input;
  }

  function choice(field, id) {
    const select = make("select", { id, aria: { describedby: `${id}-help ${id}-problem` } });
    options(select, field.choices.map((name) =>
      [name, name === field.default ? `${name} (default)` : name]));
    select.addEventListener("change", () => send({ edit: field.path, text: select.value }));
    return select;
  }

  function file(field, id) {
    const name = make("span", { className: "file-name" });
    const input = make("input", { id, type: "file", accept: ".csv,.txt",
      aria: { describedby: `${id}-help ${id}-problem` } });
    input.addEventListener("change", async () => {
      const [given] = input.files;
      if (given === undefined) return;
      const bytes = new Uint8Array(await given.slice(0, model.plan.largest + 1).arrayBuffer());
      let binary = "";
      for (const byte of bytes) binary += String.fromCharCode(byte);
      send({ upload: field.path, name: given.name, content: btoa(binary) });
      input.value = "";
    });
    return make("div", { className: "upload" }, make("label", { htmlFor: id, className: "button" },
      "choose a file", input), name);
  }

  function parts(field) {
    const button = make("button", { type: "button", className: "add" }, "add a law");
    button.addEventListener("click", () => send({ add: field.path }));
    return button;
  }

  const inputs = { flag, choice, file, tables: parts };

  function ways(section, row, id, label) {
    const select = make("select", { id, className: "ways", aria: { label } });
    options(select, row.ways.map((way, index) => [String(index), way]));
    select.value = String(row.way);
    select.addEventListener("change", () =>
      send({ alternatives: row.alternatives, of: section.path, way: Number(select.value) }));
    return select;
  }

  function row(section, field) {
    if (field.kind === "ways") {
      const id = `way-${field.name}`;
      return make("div", { className: `row ${id}` }, make("label", { htmlFor: id }, "given by"),
        ways(section, field, id, "given by"));
    }
    const id = `input-${field.name}`;
    const label = field.ways ? ways(section, field, `way-${field.name}`, "given by")
      : make("label", { htmlFor: id }, field.label);
    const input = (inputs[field.kind] ?? text)(field, id);
    if (field.ways) input.setAttribute("aria-label", field.label);
    return make("div", { className: `row field field-${field.name} ${field.kind}`,
      title: field.help, data: { path: field.path } }, label, input,
    make("span", { className: "unseen", id: `${id}-help` }, field.help), problem(id));
  }

  function draw(section) {
    const id = `choice-${section.name}`;
    const head = make("div", { className: "row head", title: section.help,
      data: { path: section.path } });
    if (section.choices.length) {
      const select = make("select", { id, className: id,
        aria: { describedby: `${id}-help ${id}-problem` } });
      const none = section.choice === "" ? [["", "choose ..."]] : [];
      options(select, [...none, ...section.choices.map((name) => [name, name])]);
      select.value = section.choice;
      select.addEventListener("change", () =>
        send({ choose: section.path, choice: select.value }));
      head.append(make("label", { htmlFor: id }, section.title), select,
        make("span", { className: "unseen", id: `${id}-help` }, section.help));
    } else {
      head.append(make("span", { className: "title" }, section.title));
    }
    if (section.part) {
      const remove = make("button", { type: "button", className: "remove",
        aria: { label: "remove this law" } }, "×");
      remove.addEventListener("click", () => send({ remove: section.path }));
      head.append(remove);
    }
    head.append(problem(id));
    const className = `section section-${section.name}${section.part ? " part" : ""}`;
    const rows = section.rows.map((field) => row(section, field));
    return make("section", { className, aria: { label: section.title } }, head, ...rows);
  }

  // Sections that did not change stay as they are, with the focus that may be in them.
  function follow_plan() {
    const plan = model.plan;
    const focused = el.getRootNode().activeElement?.id;
    if (preset.select.options.length === 0) {
      options(preset.select, [["", "values of your own"], ...plan.presets]);
      options(mode.select, [["", "choose ..."], ...plan.modes.map((name) => [name, name])]);
    }
    const old = new Map(sections);
    sections.clear();
    for (const section of plan.sections) {
      const drawn = JSON.stringify(section);
      const before = old.get(section.path);
      const node = before?.drawn === drawn ? before.node : draw(section);
      sections.set(section.path, { drawn, node, section });
    }
    for (const within of [basics, advanced]) {
      const wanted = [...sections.values()].filter((one) =>
        one.section.advanced === (within === advanced)).map((one) => one.node);
      for (const node of [...within.querySelectorAll(":scope > section")])
        if (!wanted.includes(node)) node.remove();
      wanted.forEach((node, index) => {
        const there = within.querySelectorAll(":scope > section")[index];
        if (there !== node) within.insertBefore(node, there ?? null);
      });
    }
    if (focused && el.getRootNode().activeElement?.id !== focused)
      el.querySelector(`#${CSS.escape(focused)}`)?.focus();
  }

  function fill(field, node, value) {
    const input = node.querySelector("input, select:not(.ways)");
    if (field.kind === "tables") return;
    if (field.kind === "file")
      node.querySelector(".file-name").textContent = value || "no file yet";
    else if (field.kind === "flag") input.checked = (value || field.default) === "true";
    else if (field.kind === "choice") input.value = value || field.default;
    else {
      const typing = el.getRootNode().activeElement === input
        && (input.timer !== undefined || input.sent === value);
      if (!typing && input.value !== value) input.value = value;
      input.sent = value;
    }
  }

  function mark(node, reason) {
    const input = node.querySelector("input, select:not(.ways)");
    const shown = node.querySelector(":scope > .problem");
    const missing = reason === "missing" || reason?.startsWith("missing;");
    node.classList.toggle("bad", Boolean(reason));
    input?.setAttribute("aria-invalid", String(Boolean(reason)));
    if (input?.type === "text")
      input.placeholder = missing ? `missing, ${input.dataset.example}` : input.dataset.example;
    if (!shown) return;
    shown.textContent = reason ?? "";
    shown.hidden = !reason;
    shown.classList.toggle("unseen", Boolean(missing));
  }

  function follow_state() {
    const { state } = model;
    preset.select.value = state.preset;
    mode.select.value = state.mode;
    const changes = [];
    let trouble = false;
    for (const { node, section } of sections.values()) {
      const rows = [...node.querySelectorAll(":scope > .row")];
      mark(rows[0], state.problems[section.path]);
      section.rows.forEach((field, index) => {
        if (field.kind === "ways") return;
        const value = state.texts[field.path] ?? "";
        fill(field, rows[index + 1], value);
        mark(rows[index + 1], state.problems[field.path]);
        if (section.advanced && value !== "" && value !== "false")
          changes.push(field.kind === "flag" ? field.label : `${field.label} ${value}`);
        trouble ||= section.advanced && Boolean(state.problems[field.path]);
      });
      trouble ||= section.advanced && Boolean(state.problems[section.path]);
    }
    if (trouble) advanced.open = true;
    changed.textContent = changes.join(", ");
    mark(mode.row, state.problems.mode);
    elsewhere.replaceChildren(...state.elsewhere.map(([path, reason]) => {
      const remove = make("button", { type: "button", className: "remove" }, "remove");
      remove.addEventListener("click", () => send({ remove: path }));
      return make("li", { className: "problem" }, `${path}: ${reason} `, remove);
    }));
  }

  // The strip lies over what is below the fields, which must not hide the one in use. What the
  // mouse has pressed must not move away from under it either, and shows no focus.
  el.addEventListener("focusin", ({ target }) => {
    strip.textContent = target.closest("[title]")?.title ?? "";
    if (target.matches(":focus-visible")) target.scrollIntoView({ block: "nearest" });
  });
  el.addEventListener("focusout", () => { strip.textContent = ""; });

  const follow = () => { follow_plan(); follow_state(); };
  model.on("plan", follow);
  model.on("state", follow_state);
  follow();
}
