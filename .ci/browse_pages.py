"""Opens pages that reenact wrote in headless Chromium and holds them to what people need of them.

    browse_pages.py [--shots FOLDER] PAGE.html...

Of every page: no message on the console, no request but the file itself, no link within it that leads nowhere, everything
reached by the Tab key, no page wider than a window of 360, 768 or 1280 pixels, light or dark, nothing that axe-core finds
against accessibility, and a PDF that prints. Of pages with claims, tables that sort or commands, that those work, by the
keyboard too. Prints size and load time of each. With --shots, pictures for people to look at.
"""

import argparse
import re
import shutil
import sys
from pathlib import Path

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import sync_playwright

WIDTHS = (360, 768, 1280)
LARGEST = 5_000_000  # bytes

FACTS = """() => {
  const links = [...document.querySelectorAll('a[href^="#"]')];
  return {
    broken: links.map((a) => decodeURIComponent(a.hash.slice(1))).filter((id) => !document.getElementById(id)),
    fetched: [...document.querySelectorAll("[src], link[href], a[href]")].map((e) => e.src || e.href)
      .filter((at) => !/^(data:|file:)/.test(at)),
    duplicates: [...document.querySelectorAll("[id]")].map((e) => e.id).filter((id, i, all) => all.indexOf(id) !== i),
    overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  };
}"""


def tabbed(page):
    """What the Tab key reaches, against what it should: unseen, lost and out of order are faults."""
    page.evaluate("() => { document.activeElement.blur(); scrollTo(0, 0); }")
    wanted = page.evaluate("""() => {
      const all = document.querySelectorAll('a[href], button, input, select, summary, [tabindex="0"]');
      const seen = [...all].filter((e) => e.checkVisibility() && !e.disabled);
      seen.forEach((e, i) => e.dataset.stop = i);
      return seen.length;
    }""")
    stops, rings = [], 0
    for _ in range(min(wanted, 400)):
        page.keyboard.press("Tab")
        stop, ring = page.evaluate("""() => {
          const e = document.activeElement, style = getComputedStyle(e);
          return [e.dataset.stop ?? null, style.outlineStyle !== "none" && style.outlineWidth !== "0px"];
        }""")
        stops.append(stop)
        rings += bool(ring)
    expected = [str(i) for i in range(min(wanted, 400))]
    if stops != expected:
        first = next(i for i, (a, b) in enumerate(zip(stops, expected)) if a != b)
        what = page.evaluate(f"() => document.querySelector('[data-stop=\"{first}\"]').outerHTML.slice(0, 90)")
        yield f"Tab number {first + 1} reached {stops[first]}, expected {what}"
    if rings != len(stops):
        yield f"{len(stops) - rings} of {len(stops)} stops of the Tab key show no focus"


def column(page, table, index):
    return page.evaluate(f"() => [...document.querySelectorAll('table.sortable')][{table}].tBodies[0].rows.length && "
                         f"[...[...document.querySelectorAll('table.sortable')][{table}].tBodies[0].rows]"
                         f".map((row) => row.cells[{index}].textContent.trim())")


def sorting(page):
    """Every column of every sortable table, both ways, by Enter."""
    for table in range(page.locator("table.sortable").count()):
        headings = page.locator("table.sortable").nth(table).locator("thead th")
        for index in range(headings.count()):
            button = headings.nth(index).locator("button")
            if not button.count():
                continue
            before = sorted(column(page, table, index))
            for direction, sign in (("ascending", 1), ("descending", -1)):
                button.focus()
                page.keyboard.press("Enter")
                told = headings.nth(index).get_attribute("aria-sort")
                if told != direction:
                    yield f"table {table}, column {index}: aria-sort is {told}, expected {direction}"
                texts = column(page, table, index)
                right = page.evaluate("""([texts, sign]) => texts.every((text, i) => !i ||
                  sign * texts[i - 1].localeCompare(text, "en", {numeric: true}) <= 0)""", [texts, sign])
                if not right or sorted(texts) != before:
                    yield f"table {table}, column {index} is not sorted {direction}: {texts[:4]}"


def filtering(page):
    rows = page.locator("#claims tr[data-verdict]")
    for button in page.locator(".filter button").all():
        button.focus()
        page.keyboard.press("Enter")
        count = int(re.search(r"(\d+)\s*$", button.text_content())[1])
        shown = sum(row.is_visible() for row in rows.all())
        if shown != count:
            yield f"`{button.text_content().strip()}` shows {shown} claims"
        if button.get_attribute("aria-pressed") != "true":
            yield f"`{button.text_content().strip()}` does not say that it is pressed"
    if page.locator(".filter button").count():
        page.locator(".filter button").first.click()


def opening(page):
    if page.locator("details").count():
        page.locator("summary").first.focus()
        page.keyboard.press("Enter")
        if page.locator("details").first.get_attribute("open") is None:
            yield "details do not open by Enter"
        page.keyboard.press("Enter")
    # What is folded is to work like the rest.
    page.evaluate("() => document.querySelectorAll('details').forEach((part) => { part.open = true; })")


def copying(page):
    for button in page.locator("button.copy").all():
        line = button.locator("xpath=../pre/code").text_content()
        button.focus()
        page.keyboard.press("Enter")
        page.wait_for_function("() => document.getElementById('told').textContent.startsWith('command')")
        copied = page.evaluate("() => navigator.clipboard.readText()")
        if copied != line:
            yield f"copied `{copied}`, expected `{line}`"
    for tick in page.locator(".ticks input").all():
        tick.focus()
        page.keyboard.press("Space")
        if not tick.is_checked():
            yield "a box of the checklist is not ticked by Space"


def replaying(page):
    """The curve of a replay moves its time, by mouse and keys; the map zooms; nothing is covered, and drawing is quick."""
    curve = page.locator("[role=slider]")
    if not curve.count():
        return
    now = lambda: float(curve.get_attribute("aria-valuenow"))
    end = float(curve.get_attribute("aria-valuemax"))
    drawn = lambda: page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    curve.focus()
    for key, expected in (("End", end), ("Home", 0)):
        page.keyboard.press(key)
        drawn()
        if abs(now() - expected) > 0.1:
            yield f"{key} on the curve leads to {now()} s, expected {expected} s"
    box = curve.bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.3, box["y"] + 40)
    page.mouse.down()
    drawn()
    first = now()
    page.mouse.move(box["x"] + box["width"] * 0.6, box["y"] + 40)
    page.mouse.up()
    drawn()
    if not 0 < first < now() < end:
        yield f"dragging on the curve leads from {first} s to {now()} s of {end} s"
    whole = page.evaluate("() => lensOf(trials[0]).zoom")
    page.locator(".zoom button").nth(1).click()
    closer = page.evaluate("() => lensOf(trials[0]).zoom")
    page.locator(".trial canvas").first.focus()
    page.keyboard.press("0")
    if not whole == 1 < closer or page.evaluate("() => lensOf(trials[0]).zoom") != 1:
        yield f"the map zooms from {whole} to {closer} and not back"
    for width, height in ((1280, 800), (390, 844)):
        page.set_viewport_size({"width": width, "height": height})
        drawn()
        below, parts = 0, page.evaluate("""() => [".trial canvas", ".chart", ".controls"].map((name) => {
          const { top, bottom } = document.querySelector(name).getBoundingClientRect();
          return [name, top + scrollY, bottom + scrollY];
        })""")
        # Two trials do not fit on a phone beside their controls.
        fits = width > 400 or page.locator(".trial canvas").count() == 1
        for name, top, bottom in parts:
            if top < below or (fits and bottom > height):
                yield f"{width} x {height}: {name} from {top:.0f} to {bottom:.0f} is covered or off the screen"
            below = bottom
    page.set_viewport_size({"width": 1280, "height": 900})
    # A quarter of this machine's speed, and still 25 pictures a second.
    slow = page.context.new_cdp_session(page)
    slow.send("Emulation.setCPUThrottlingRate", {"rate": 4})
    mean = page.evaluate("""() => {
      const began = performance.now(), count = 100;
      for (let i = 0; i < count; i++) {
        now = end * i / count;
        draw();
      }
      // What was only asked for until now is drawn.
      panels.forEach((panel) => panel.canvas.getContext("2d").getImageData(0, 0, 1, 1));
      return (performance.now() - began) / count;
    }""")
    slow.send("Emulation.setCPUThrottlingRate", {"rate": 1})
    print(f"      an instant is drawn in {mean:.1f} ms at a quarter of the speed")
    if mean > 40:
        yield f"an instant takes {mean:.1f} ms at a quarter of the speed, expected at most 40 ms"


def violations(page):
    for found in Axe().run(page).response["violations"]:
        nodes = found["nodes"]
        yield f"axe {found['id']} ({found['impact']}), {len(nodes)} times: {found['help']}: {nodes[0]['html'][:160]}"


def browse(browser, path, shots):
    faults, said, asked = [], [], []
    address = path.resolve().as_uri()
    context = browser.new_context(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    page = context.new_page()
    page.on("console", lambda message: said.append(f"console {message.type}: {message.text}"))
    page.on("pageerror", lambda error: said.append(f"error in the page: {error}"))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address, wait_until="load")
    load = page.evaluate("() => performance.getEntriesByType('navigation')[0].loadEventEnd")
    page.wait_for_timeout(300)
    size = path.stat().st_size
    if size > LARGEST:
        faults.append(f"{size} bytes, expected at most {LARGEST}")
    facts = page.evaluate(FACTS)
    faults += [f"a link leads to #{id}, which is nowhere" for id in facts["broken"]]
    faults += [f"a link out of the page: {at}" for at in facts["fetched"]]
    faults += [f"two elements have the id {id}" for id in facts["duplicates"]]
    faults += violations(page)
    for check in (tabbed, opening, sorting, filtering, copying, replaying):
        faults += check(page)
    page.reload(wait_until="load")
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            page.wait_for_timeout(100)
            overflow = page.evaluate(FACTS)["overflow"]
            if overflow > 0:
                faults.append(f"{scheme}, {width} pixels: the page is {overflow} pixels too wide")
            if shots:
                page.screenshot(path=shots / f"{path.stem}-{scheme}-{width}.png", full_page=True)
        faults += [f"{scheme}, {WIDTHS[0]} pixels: {fault}" for fault in violations_at(page, WIDTHS[0])]
    page.emulate_media(color_scheme="light")
    pdf = page.pdf(format="A4", print_background=False, margin={side: "15mm" for side in ("top", "bottom", "left", "right")})
    if not pdf.startswith(b"%PDF") or b"/Page" not in pdf:
        faults.append("printing gives no PDF")
    if shots:
        (shots / f"{path.stem}.pdf").write_bytes(pdf)
    faults += said
    # The page of a bundle shows what lies beside it.
    own = path.resolve().parent.as_uri() + "/results/" if path.name == "index.html" else "data:"
    strange = {url for url in asked if url != address and not url.startswith(("data:", own))}
    faults += [f"a request: {url}" for url in sorted(strange)]
    context.close()
    print(f"{'FAIL' if faults else 'ok  '}  {path.name}: {size / 1000:.0f} kB, loaded in {load:.0f} ms, PDF {len(pdf) / 1000:.0f} kB")
    for fault in faults:
        print(f"      {fault}")
    return not faults


def violations_at(page, width):
    page.set_viewport_size({"width": width, "height": 900})
    return list(violations(page))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--shots", type=Path)
    arguments = parser.parse_args()
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    chromium = next(filter(None, map(shutil.which, names)), None)
    if not chromium:
        sys.exit(f"expected one of {', '.join(names)} on the PATH, found none: install Chromium (Debian: apt-get install chromium)")
    if arguments.shots:
        arguments.shots.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        good = [browse(browser, path, arguments.shots) for path in arguments.pages]
        browser.close()
    sys.exit(not all(good))


if __name__ == "__main__":
    main()
