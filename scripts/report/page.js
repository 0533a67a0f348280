/* Of reports and the atlas: copies commands, and opens pictures large. The page works without it but for these two. */
(function () {
  "use strict";

  /* A page that was opened as a file may have no clipboard; then its text is selected and copied as by hand. */
  function copied(text) {
    if (navigator.clipboard && window.isSecureContext) {
      return navigator.clipboard.writeText(text).catch(function () { return byHand(text); });
    }
    return byHand(text);
  }

  function byHand(text) {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done ? Promise.resolve() : Promise.reject(new Error("not copied"));
  }

  function copy(button) {
    const said = function (words) {
      button.textContent = words;
      setTimeout(function () { button.textContent = "Copy"; }, 2000);
    };
    copied(button.parentElement.querySelector("code").textContent)
      .then(function () { said("Copied"); }, function () { said("Select it"); });
  }

  function enlarge(picture) {
    const dialog = document.createElement("dialog"), close = document.createElement("button");
    close.textContent = "Close";
    close.className = "close";
    dialog.className = "large";
    dialog.append(close, picture.cloneNode(true));
    dialog.addEventListener("click", function () { dialog.close(); });
    dialog.addEventListener("close", function () { dialog.remove(); });
    document.body.append(dialog);
    dialog.showModal();
  }

  document.addEventListener("click", function (event) {
    const button = event.target.closest("button");
    if (button && button.className === "copy") copy(button);
    if (button && button.className === "enlarge") enlarge(button.firstElementChild);
  });
})();
