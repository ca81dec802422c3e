"""Opens verify.html in headless Chromium, from its file, and holds it to what a reviewer needs of it.

    browse_verify.py check [--shots FOLDER] VERIFY.html SMALL.zip LARGE.zip REENACT
    browse_verify.py run VERIFY.html MANIFEST... [--trials N] [--only FACTOR=VALUE]...

`check`: the small bundle climbs to level 5, the large one to level 4, each in time and in the words of the command REENACT; the report
shows, two trials play beside each other; a signature is checked; a damaged bundle, one that is none and a key file that is none are told as by the command;
`?bundle=` leads to no other site; a check is cancelled; nothing is said on the console and nothing is asked of the network; no window of
360 to 1280 pixels is too narrow; axe-core finds nothing. `run` prints the results digest of each manifest as `reenact run --format json`
does, one line each: the determinism contract in a browser (.ci/determinism.sh).
"""

import argparse
import base64
import functools
import http.server
import json
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

WIDTHS = (360, 768, 1280)
LARGEST = 6_291_456  # bytes
FINISHED = "() => document.documentElement.dataset.exit !== undefined && document.getElementById('cancel').hidden"


def launched(playwright):
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    chromium = next(filter(None, map(shutil.which, names)), None)
    if not chromium:
        sys.exit(f"expected one of {', '.join(names)} on the PATH, found none: install Chromium (Debian: apt-get install chromium)")
    return playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])


def surroundings(manifest):
    """Every file that a manifest may name, as one beside it names it."""
    root = manifest.resolve().parent.parent
    for folder in ("manifests", "robots", "worlds"):
        for path in sorted((root / folder).rglob("*")):
            if path.is_file():
                up = "" if folder == "manifests" else "../"
                name = path.relative_to(root / "manifests" if not up else root)
                yield up + name.as_posix(), path.read_bytes()


def run(arguments):
    with sync_playwright() as playwright:
        browser = launched(playwright)
        page = browser.new_page()
        page.goto(arguments.page.resolve().as_uri())
        for manifest in arguments.manifests:
            files = list(surroundings(manifest))
            asked = {"do": "run", "manifest": manifest.name, "files": [[name, len(content)] for name, content in files],
                     "only": arguments.only, "trials": arguments.trials}
            body = base64.b64encode(b"".join(content for _, content in files)).decode()
            told = page.evaluate("""async ([asked, body]) => {
              const bytes = Uint8Array.from(atob(body), (letter) => letter.charCodeAt(0));
              const checker = new Checker();
              const { told } = await checker.ask(asked, bytes);
              checker.end();
              return told;
            }""", [asked, body])
            if told["failed"]:
                sys.exit(f"{manifest}: {told['failed']} trials failed")
            print(json.dumps(told, separators=(",", ":")))
        browser.close()


class Checks:
    def __init__(self, browser, arguments, work):
        self.browser, self.arguments, self.work = browser, arguments, work
        self.faults = []

    def fault(self, where, text):
        self.faults.append(f"{where}: {text}")

    def opened(self, address=None, **options):
        context = self.browser.new_context(viewport={"width": 1280, "height": 900}, reduced_motion="reduce", **options)
        page = context.new_page()
        page.said, page.asked = [], []
        page.on("console", lambda message: page.said.append(f"console {message.type}: {message.text}"))
        page.on("pageerror", lambda error: page.said.append(f"error in the page: {error}"))
        page.on("request", lambda request: page.asked.append(request.url))
        page.goto(address or self.arguments.page.resolve().as_uri(), wait_until="load")
        return page

    def closed(self, page, where, allowed=("data:", "blob:")):
        own = self.arguments.page.resolve().as_uri()
        for text in page.said:
            self.fault(where, text)
        for url in page.asked:
            if url != own and not url.startswith(allowed) and not url.startswith("about:"):
                self.fault(where, f"a request: {url}")
        page.context.close()

    def command(self, bundle, level, trust=None):
        # The page knows a key file by its name alone.
        trusted = ["--trust", trust.name] if trust else []
        told = subprocess.run([self.arguments.reenact, "verify", bundle.resolve(), "--level", str(level), *trusted],
                              cwd=trust.parent if trust else None, capture_output=True, text=True)
        return told.returncode, told.stdout

    def words(self, page):
        """What the page says that the command prints; the seed is drawn afresh."""
        return page.locator("#said").text_content()

    def compared(self, page, where, bundle, level, trust=None):
        code, text = self.command(bundle, level, trust)
        seed = lambda said: re.sub(r"drawn with seed \d+", "drawn with seed *", said)
        found = page.evaluate("() => document.documentElement.dataset.exit")
        if found != str(code):
            self.fault(where, f"exit {found}, expected {code} as by the command")
        if seed(self.words(page)) != seed(text):
            self.fault(where, f"says\n{self.words(page)}\nwhere the command says\n{text}")

    def given(self, page, bundle, level="auto"):
        page.evaluate("() => { delete document.documentElement.dataset.exit; }")
        page.select_option("#level", level)
        page.set_input_files("#file", bundle)

    def finished(self, page, where, most):
        began = time.monotonic()
        try:
            page.wait_for_function(FINISHED, timeout=1000 * most * 6)
        except Exception:
            self.fault(where, f"not finished in {most * 6} s: {page.locator('#doing').text_content()}")
            return
        facts = page.evaluate("() => ({...document.documentElement.dataset})")
        span = float(facts.get("seconds", time.monotonic() - began))
        peak = int(facts.get("memory", 0)) >> 20
        print(f"      {where}: {span:.1f} s, a worker took {peak} MiB at most", flush=True)
        if span > most:
            self.fault(where, f"took {span:.1f} s, expected at most {most} s")

    def shot(self, page, name, **options):
        if self.arguments.shots:
            page.screenshot(path=self.arguments.shots / f"{name}.png", **options)

    def violations(self, page, where):
        from axe_playwright_python.sync_playwright import Axe
        for found in Axe().run(page, options={"iframes": False}).response["violations"]:
            self.fault(where, f"axe {found['id']} ({found['impact']}): {found['help']}: {found['nodes'][0]['html'][:160]}")

    def fits(self, page, where):
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            for width in WIDTHS:
                page.set_viewport_size({"width": width, "height": 900})
                page.wait_for_timeout(100)
                over = page.evaluate("() => document.documentElement.scrollWidth - document.documentElement.clientWidth")
                if over > 0:
                    self.fault(where, f"{scheme}, {width} pixels: the page is {over} pixels too wide")
                self.shot(page, f"{where}-{scheme}-{width}", full_page=True)
            self.violations(page, f"{where} {scheme}")
        page.emulate_media(color_scheme="light")
        page.set_viewport_size({"width": 1280, "height": 900})

    def empty(self):
        page = self.opened()
        self.fits(page, "empty")
        self.closed(page, "empty")

    def small(self):
        page = self.opened()
        self.given(page, self.arguments.small)
        self.finished(page, "level 5", 10)
        self.compared(page, "level 5", self.arguments.small, 5)
        states = page.locator("#rungs .state").all_text_contents()
        if states != ["✓ passed"] * 6:
            self.fault("level 5", f"the rungs say {states}")
        heading = page.frame_locator("#report").locator("h1").text_content(timeout=20000)
        if not heading:
            self.fault("level 5", "the report has no heading")
        page.locator("#play").focus()
        page.keyboard.press("Enter")
        replay = page.frame_locator("#replay")
        replay.locator(".trial canvas").nth(1).wait_for(timeout=60000)
        if replay.locator(".trial canvas").count() != 2:
            self.fault("replay", "two trials do not play beside each other")
        narrow = replay.locator("canvas").evaluate_all("all => all.filter((one) => one.width < 200).length")
        if narrow:
            self.fault("replay", f"{narrow} of its drawings have no room")
        told = page.locator("#played").text_content()
        if told.count("equals the archived one") != 2:
            self.fault("replay", f"it says: {told}")
        replay.locator("#play").click()
        clock = replay.locator("#clock")
        before = clock.text_content()
        page.wait_for_timeout(600)
        if clock.text_content() == before:
            self.fault("replay", f"time stands still at {before}")
        replay.locator("#play").click()
        self.fits(page, "small")
        self.closed(page, "small")

    def large(self):
        page = self.opened()
        self.given(page, self.arguments.large, "3")
        self.finished(page, "large, level 3", 4)
        self.compared(page, "large, level 3", self.arguments.large, 3)
        self.given(page, self.arguments.large, "4")
        self.finished(page, "large, level 4", 30)
        if page.evaluate("() => document.documentElement.dataset.exit") != "0":
            self.fault("large, level 4", self.words(page))
        self.shot(page, "large")
        self.given(page, self.arguments.large, "5")
        page.wait_for_function("() => /executed again/.test(document.getElementById('doing').textContent)", timeout=60000)
        page.locator("#cancel").click()
        if "Cancelled" not in page.locator("#answer").text_content():
            self.fault("cancelled", page.locator("#answer").text_content())
        # The page goes on to work.
        self.given(page, self.arguments.small, "3")
        self.finished(page, "after a cancelled check", 10)
        self.closed(page, "large")

    def damaged(self):
        page = self.opened()
        content = bytearray(self.arguments.small.read_bytes())
        content[len(content) // 2] ^= 1
        for name, made in (("damaged", bytes(content)), ("no zip", b"not a zip at all"), ("empty", b"")):
            bundle = self.work / "bundle.zip"
            bundle.write_bytes(made)
            self.given(page, bundle, "5")
            self.finished(page, name, 10)
            self.compared(page, name, bundle, 5)
        self.shot(page, "damaged")
        keys = self.work / "keys"
        keys.write_text("these are no keys\n")
        page.locator("#vouching summary").click()
        page.set_input_files("#trust", keys)
        self.given(page, self.arguments.small, "3")
        self.finished(page, "keys", 10)
        told = subprocess.run([self.arguments.reenact, "verify", "--trust", "keys", self.arguments.small.resolve()], cwd=self.work,
                              capture_output=True, text=True)
        said = page.locator("#answer").text_content()
        if told.stderr.strip() not in said or page.evaluate("() => document.documentElement.dataset.exit") != str(told.returncode):
            self.fault("keys", f"says {said}\nwhere the command says {told.stderr}")
        self.closed(page, "damaged")

    def signed(self):
        """A bundle that an author signed, with that author's key and with a stranger's."""
        quietly = functools.partial(subprocess.run, check=True, capture_output=True, cwd=self.work)
        small = self.arguments.small.resolve()
        for name in ("author", "stranger"):
            quietly(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", name, "-f", name])
            public = (self.work / f"{name}.pub").read_text()
            (self.work / f"{name}.signers").write_text(f'{name}@example.org namespaces="reenact" {public}')
        quietly([self.arguments.reenact, "export", small, "--dir", "--out", "unpacked"])
        (listed,) = (self.work / "unpacked").glob("*/tagmanifest-sha256.txt")
        quietly(["ssh-keygen", "-Y", "sign", "-f", "author", "-n", "reenact", listed])
        quietly([self.arguments.reenact, "export", small, "--signature", f"{listed}.sig", "--out", "signed"])
        (bundle,) = (self.work / "signed").glob("*.zip")
        page = self.opened()
        page.locator("#vouching summary").click()
        for name, exit in (("author", "0"), ("stranger", "1")):
            signers = self.work / f"{name}.signers"
            page.set_input_files("#trust", signers)
            self.given(page, bundle, "3")
            self.finished(page, f"signed, the {name} trusted", 10)
            self.compared(page, f"signed, the {name} trusted", bundle, 3, signers)
            if page.evaluate("() => document.documentElement.dataset.exit") != exit:
                self.fault("signed", f"the {name} trusted: {self.words(page)}")
        self.shot(page, "signed")
        self.closed(page, "signed")

    def site(self):
        folder = self.work / "site"
        subprocess.run([self.arguments.reenact, "export", self.arguments.small, "--site", folder, "--page", self.arguments.page], check=True,
                       capture_output=True)
        handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=folder)
        handler.log_message = lambda *_: None
        http.server.SimpleHTTPRequestHandler.log_message = lambda *_: None
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        root = f"http://127.0.0.1:{server.server_port}/"
        page = self.opened(root + "index.html")
        self.fits(page, "site")
        page.get_by_role("link", name="Check it in your browser").click()
        self.finished(page, "site", 15)
        if page.evaluate("() => document.documentElement.dataset.level") != "5":
            self.fault("site", self.words(page))
        page.goto(root + "verify.html?bundle=https://example.org/study.zip")
        page.locator("#verdict").wait_for()
        said = page.locator("#answer").text_content()
        if "on this page's own site" not in said:
            self.fault("site", said)
        self.closed(page, "site", ("data:", "blob:", root))
        server.shutdown()


def check(arguments):
    size = arguments.page.stat().st_size
    if arguments.shots:
        arguments.shots.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as work:
        checks = Checks(launched(playwright), arguments, Path(work))
        if size > LARGEST:
            checks.fault("size", f"{size} bytes, expected at most {LARGEST}")
        for one in (checks.empty, checks.small, checks.damaged, checks.signed, checks.large, checks.site):
            try:
                one()
            except Exception as error:
                checks.fault(one.__name__, f"{type(error).__name__}: {error}")
    print(f"{'FAIL' if checks.faults else 'ok  '}  {arguments.page.name}: {size / 1e6:.2f} MB")
    for fault in checks.faults:
        print(f"      {fault}")
    sys.exit(bool(checks.faults))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    tasks = parser.add_subparsers(required=True)
    one = tasks.add_parser("check")
    one.add_argument("--shots", type=Path)
    for name in ("page", "small", "large", "reenact"):
        one.add_argument(name, type=Path)
    one.set_defaults(do=check)
    one = tasks.add_parser("run")
    one.add_argument("page", type=Path)
    one.add_argument("manifests", nargs="+", type=Path)
    one.add_argument("--trials", type=int)
    one.add_argument("--only", action="append", default=[])
    # As `run` takes them; nothing is written here.
    one.add_argument("--out")
    one.add_argument("--format")
    one.set_defaults(do=run)
    arguments = parser.parse_args()
    if hasattr(arguments, "reenact"):
        arguments.reenact = arguments.reenact.resolve()
    arguments.do(arguments)


if __name__ == "__main__":
    main()
