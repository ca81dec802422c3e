
// Claims can be narrowed to one verdict.
for (const group of document.querySelectorAll(".filter")) {
  group.hidden = false;
  const rows = [...group.parentElement.querySelectorAll("tr[data-verdict]")];
  const buttons = [...group.querySelectorAll("button")];
  for (const button of buttons) {
    button.addEventListener("click", () => {
      const wanted = button.dataset.show;
      const fits = (row) => !wanted || row.dataset.verdict === wanted || (wanted === "differs" && "differs" in row.dataset);
      for (const row of rows) row.hidden = !fits(row);
      for (const other of buttons) other.setAttribute("aria-pressed", String(other === button));
      tell(`${rows.filter((row) => !row.hidden).length} of ${rows.length} claims shown`);
    });
  }
}

// Whoever follows a link to a claim sees it, whatever is filtered out.
const unhide = () => {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (target && target.hidden) document.querySelector('.filter button[data-show=""]').click();
};
addEventListener("hashchange", unhide);

// Commands are copied by a button. Where the clipboard is closed to files, the line is selected instead.
for (const button of document.querySelectorAll("button.copy")) {
  button.hidden = false;
  const line = button.parentElement.querySelector("code");
  button.addEventListener("click", async () => {
    let done = "copied";
    try {
      await navigator.clipboard.writeText(line.textContent);
    } catch {
      getSelection().selectAllChildren(line);
      if (!document.execCommand("copy")) done = "selected: copy it with your keyboard";
    }
    tell(`command ${done}`);
    button.dataset.done = done;
    setTimeout(() => delete button.dataset.done, 2000);
  });
}

// Whoever follows a link into what is folded sees it.
const unfold = () => {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let part = target; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  if (target) target.scrollIntoView();
};
addEventListener("hashchange", unfold);
if (location.hash) unfold();
