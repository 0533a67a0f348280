/* Of the atlas: sorts and searches the table, and shows the command of a number. */
(function () {
  "use strict";
  const table = document.getElementById("atlas"), body = table.tBodies[0], heads = [...table.tHead.rows[0].cells];
  const commands = JSON.parse(document.getElementById("commands").textContent);
  const search = document.getElementById("search"), asked = document.getElementById("asked");
  const columns = heads.map(function (head) { return head.dataset.key; });
  const rows = [...body.rows].map(function (row) {
    const values = {};
    columns.forEach(function (key, at) {
      const data = row.cells[at].dataset.value;
      values[key] = data === undefined ? row.cells[at].textContent : data === "" ? NaN : Number(data);
    });
    return { row: row, values: values };
  });
  let need = {}, keys = [];

  /* What is not known comes last in either direction. */
  function compared(one, other) {
    for (const [key, sign] of keys) {
      const a = one.values[key], b = other.values[key];
      if (typeof a === "string") {
        if (a !== b) return sign * (a < b ? -1 : 1);
      } else if (Number.isNaN(a) || Number.isNaN(b)) {
        if (Number.isNaN(a) !== Number.isNaN(b)) return Number.isNaN(a) ? 1 : -1;
      } else if (a !== b) {
        return sign * (a < b ? -1 : 1);
      }
    }
    return 0;
  }

  function within(values) {
    return Object.entries(need).every(function ([key, [low, high]]) {
      return !Number.isNaN(values[key]) && (low === null || values[key] >= low) && (high === null || values[key] <= high);
    });
  }

  function show() {
    const wanted = search.value.toLowerCase().split(/[\s,]+/).filter(Boolean);
    let count = 0;
    rows.sort(compared);
    for (const one of rows) {
      const own = one.row.dataset.words.split(" ");
      const fits = within(one.values) && wanted.every(function (word) {
        return own.some(function (other) { return other.startsWith(word); });
      });
      one.row.hidden = !fits;
      count += fits;
      body.append(one.row);
    }
    document.getElementById("count").textContent = count + " of " + rows.length + " schemes";
    for (const head of heads) {
      const found = keys.length && keys[0][0] === head.dataset.key ? keys[0][1] : 0;
      head.setAttribute("aria-sort", found > 0 ? "ascending" : found < 0 ? "descending" : "none");
    }
  }

  function ask(button) {
    keys = JSON.parse(button.dataset.keys);
    need = JSON.parse(button.dataset.need);
    document.getElementById("words").textContent = button.dataset.words;
    for (const other of document.querySelectorAll(".ask")) other.setAttribute("aria-pressed", String(other === button));
    show();
  }

  function sortBy(key) {
    const same = keys.length && keys[0][0] === key;
    keys = [[key, same ? -keys[0][1] : 1]];
    need = {};
    document.getElementById("words").textContent = "";
    for (const other of document.querySelectorAll(".ask")) other.setAttribute("aria-pressed", "false");
    show();
  }

  /* The command of a number: the task, the scheme of the row, and what the question adds. */
  function showCommand(cell) {
    const row = cell.parentElement, question = heads[cell.cellIndex].dataset.question;
    if (!question) return;
    const [task, options] = commands[row.dataset.dim][question];
    const box = document.createElement("div"), button = document.createElement("button");
    const code = document.createElement("code"), pre = document.createElement("pre");
    box.className = "command";
    button.type = "button";
    button.className = "copy";
    button.textContent = "Copy";
    for (const text of (task + " " + row.dataset.scheme + " " + options).split(" ")) {
      const word = document.createElement("span");
      word.className = "word";
      word.textContent = text;
      code.append(...(code.hasChildNodes() ? [" ", word] : [word]));
    }
    pre.append(code);
    box.append(button, pre);
    asked.replaceChildren(box);
    asked.hidden = false;
  }

  document.addEventListener("click", function (event) {
    const sort = event.target.closest("button.sort"), question = event.target.closest("button.ask");
    const cell = event.target.closest("#atlas tbody td");
    if (sort) sortBy(sort.parentElement.dataset.key);
    if (question) ask(question);
    if (cell) showCommand(cell);
  });
  search.addEventListener("input", show);
  ask(document.querySelector(".ask"));
})();
