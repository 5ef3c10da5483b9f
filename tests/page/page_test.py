#!/usr/bin/python3
"""The report's pages in a real browser: usage: page_test.py PAGE.html...

Opens each page from its file in headless Chromium, driven by Selenium (Debian: chromium-driver,
python3-selenium), and checks what only a browser can tell: no console message, no network request,
every chart drawn, the divider and the pixel inspector at work under clicks and keys, and that the
page can be read by keyboard. The first page that has an inspector is then broken on purpose, one
way after another: a check that does not notice has failed.
"""

import json
import pathlib
import sys
import tempfile

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.chrome.service import Service

WIDE = (1400, 1000)
NARROW = (420, 900)
CHROMEDRIVER = "/usr/bin/chromedriver"
CHROMIUM = "/usr/bin/chromium"
TAB_STOPS = 40  # enough to reach the tables and the inspector of the first scene


def require(condition, message):
    if not condition:
        raise AssertionError(message)


# ---- The browser.


def open_browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run",
                     "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(CHROMEDRIVER), options=options)


def load(browser, page):
    browser.get_log("browser")  # reading empties the logs: what other pages left is not ours
    browser.get_log("performance")
    browser.set_window_size(*WIDE)
    browser.get(page.resolve().as_uri())


# ---- Checks of any page.


def check_console(browser):
    messages = [entry["message"] for entry in browser.get_log("browser")]
    require(not messages, f"console: {messages}")


def check_network(browser, page):
    requests = []
    for entry in browser.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            requests.append(message["params"]["request"]["url"])
    # What the page asks for once it runs; the page itself is the one request there must be.
    others = [url[:80] for url in requests
              if not url.startswith("data:") and url.split("#")[0] != page.resolve().as_uri()]
    require(not others, f"requests: {others}")


def check_charts(browser):
    charts = browser.execute_script("""
        return [...document.querySelectorAll("[data-chart]")].map((plot) => {
            const canvas = plot.querySelector("canvas");
            // Read from a copy: Chromium warns where a canvas that it draws on is read back.
            const copy = document.createElement("canvas");
            [copy.width, copy.height] = [canvas.width, canvas.height];
            const ctx = copy.getContext("2d", { willReadFrequently: true });
            ctx.drawImage(canvas, 0, 0);
            const { data } = ctx.getImageData(0, 0, copy.width, copy.height);
            const colours = new Set();
            for (let i = 0; i < data.length; i += 4) {
                if (data[i + 3] > 127) colours.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
            }
            return { kind: plot.dataset.chart, drawn: plot.dataset.drawn, colours: colours.size,
                     label: canvas.getAttribute("aria-label") };
        });""")
    for chart in charts:
        # Axes alone are two or three greys and the smooth edges of their letters' grey.
        require(chart["drawn"] == "true" and chart["colours"] > 8, f"not drawn: {chart}")
        require(chart["label"], f"without a description: {chart}")
    return len(charts)


def check_structure(browser):
    levels = browser.execute_script("""
        return [...document.querySelectorAll("h1, h2, h3, h4, h5")]
            .filter((h) => h.checkVisibility()).map((h) => [Number(h.tagName[1]), h.textContent]);""")
    require([level for level, _ in levels].count(1) == 1, "not one h1")
    for (before, _), (level, text) in zip(levels, levels[1:]):
        require(level <= before + 1, f"heading skips a level: {text}")
    nameless = browser.execute_script("""
        return [...document.querySelectorAll("main img, main canvas[role=img], main button, main select")]
            .filter((e) => e.checkVisibility())
            .filter((e) => !(e.alt || e.getAttribute("aria-label") || e.textContent.trim()))
            .map((e) => e.outerHTML.slice(0, 80));""")
    require(not nameless, f"without a text: {nameless}")
    broken = browser.execute_script("""
        return [...document.querySelectorAll("main img")].filter((i) => i.src && i.complete && i.naturalWidth === 0).length;""")
    require(broken == 0, f"{broken} pictures that do not show")
    twice = browser.execute_script("""
        const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
        return ids.filter((id, i) => ids.indexOf(id) !== i);""")
    require(not twice, f"ids given twice: {twice}")


def check_width(browser):
    for size in (WIDE, NARROW):
        browser.set_window_size(*size)
        over = browser.execute_script("""
            return document.documentElement.scrollWidth - document.documentElement.clientWidth;""")
        require(over <= 0, f"{over} pixels wider than a window of {size[0]}")
        cut = browser.execute_script("""
            return [...document.querySelectorAll(".legend li")]
                .filter((li) => li.checkVisibility() && li.scrollWidth > li.clientWidth + 1).length;""")
        require(cut == 0, f"{cut} legend texts cut off at {size[0]}")
    browser.set_window_size(*WIDE)


def check_keyboard(browser):
    """Tab goes down the page, and what has the focus is seen to have it."""
    browser.execute_script("document.activeElement.blur(); scrollTo(0, 0); window.lastFocus = null;")
    for _ in range(TAB_STOPS):
        ActionChains(browser).send_keys(Keys.TAB).perform()
        state = browser.execute_script("""
            const now = document.activeElement, last = window.lastFocus;
            window.lastFocus = now;
            return { name: now.outerHTML.slice(0, 80), body: now === document.body,
                     seen: getComputedStyle(now).outlineStyle !== "none",
                     backwards: last && last !== document.body && now !== document.body
                         && !(last.compareDocumentPosition(now) & Node.DOCUMENT_POSITION_FOLLOWING) };""")
        if state["body"]:
            return
        require(state["seen"], f"focus not to be seen: {state['name']}")
        require(not state["backwards"], f"focus goes back: {state['name']}")


def check_preferences(browser):
    """Dark, and without motion."""
    def emulate(scheme, motion):
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
            {"name": "prefers-color-scheme", "value": scheme},
            {"name": "prefers-reduced-motion", "value": motion}]})
    style = "return getComputedStyle(document.documentElement)[arguments[0]];"
    emulate("light", "no-preference")
    light = browser.execute_script(style, "backgroundColor")
    emulate("dark", "reduce")
    require(browser.execute_script(style, "backgroundColor") != light, "no dark page")
    require(browser.execute_script(style, "scrollBehavior") == "auto", "moves although asked not to")
    check_charts(browser)
    emulate("light", "no-preference")


# ---- The closer look.


def check_divider(browser, closer):
    slider = closer.find_element(By.CSS_SELECTOR, "input[type=range]")
    clip = "return getComputedStyle(arguments[0].querySelector('.over')).clipPath;"
    pictures = browser.execute_script("""
        return [...arguments[0].querySelectorAll(".stage img")].map((i) => [i.src, i.alt, i.naturalWidth]);""",
        closer)
    require(all(width > 0 for _, _, width in pictures), "a picture under the divider is missing")
    require(pictures[0][1] != pictures[1][1], "the same picture on both sides")
    before = browser.execute_script(clip, closer)
    slider.send_keys(Keys.HOME)
    at_start = browser.execute_script(clip, closer)
    slider.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    after = browser.execute_script(clip, closer)
    require(len({before, at_start, after}) == 3, f"keys do not move the divider: {before}, {after}")
    require(slider.get_attribute("value") == "2", "two keys are not two steps")

    right = closer.find_element(By.CSS_SELECTOR, "select[data-side=right]")
    cells = right.find_element(By.CSS_SELECTOR, "optgroup[label='Cells visited'] option")
    cells.click()
    shown = closer.find_element(By.CSS_SELECTOR, ".over").get_attribute("alt")
    require(shown.startswith("Cells visited"), f"the heat map does not show: {shown}")


def check_inspector(browser, closer):
    sheet = browser.execute_script("""
        const data = JSON.parse(document.getElementById("onepass-data").textContent);
        return data.closer[Number(arguments[0].dataset.closer)].sheet;""", closer)
    stage = closer.find_element(By.CSS_SELECTOR, ".stage")
    # A click is aimed at the last frame that was shown: wait for one with the new place.
    browser.execute_async_script("""
        arguments[0].scrollIntoView({ block: 'center', behavior: 'instant' });
        requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(arguments[1], 100)));""",
        stage)
    where = lambda: closer.find_element(By.CSS_SELECTOR, ".where").text
    column = lambda tracer, field: sheet["columns"][tracer[field]]

    def check_reading(index):
        """The table holds what the sheet does."""
        x, y = sheet["pixels"][index] % sheet["width"], sheet["pixels"][index] // sheet["width"]
        require(where().startswith(f"Pixel ({x}, {y})"), f"{where()} instead of ({x}, {y})")
        rows = [[cell.text for cell in row.find_elements(By.CSS_SELECTOR, "th, td")]
                for row in closer.find_elements(By.CSS_SELECTOR, ".reading tbody tr")]
        require(len(rows) == len(sheet["tracers"]), "not a row a tracer")
        for row, tracer in zip(rows, sheet["tracers"]):
            require(row[0] == tracer["name"], f"{row[0]} instead of {tracer['name']}")
            require(row[1] == sheet["classes"][column(tracer, "class")[index]], f"class: {row}")
            t, prim = column(tracer, "t")[index], column(tracer, "prim")[index]
            require(row[2] == "miss" if t is None else float(row[2]) == t, f"t: {row}, {t}")
            require(row[3] == "–" if prim < 0 else int(row[3]) == prim, f"prim_id: {row}, {prim}")
            if "cells" in tracer:
                cells = column(tracer, "cells")[index]
                require(int(row[5].replace(",", "")) == cells, f"cells: {row}, {cells}")
            if "color" in tracer:
                require(row[7] == f"#{column(tracer, 'color')[index]:06x}", f"colour: {row}")

    def index_of(x, y):
        """Of the pixel that is kept nearest to (x, y); the first of equals, as on the page."""
        return min(range(len(sheet["pixels"])), key=lambda i: (
            (sheet["pixels"][i] % sheet["width"] - x) ** 2
            + (sheet["pixels"][i] // sheet["width"] - y) ** 2, i))

    # A click in the middle of a pixel that is kept.
    index = len(sheet["pixels"]) // 3
    x, y = sheet["pixels"][index] % sheet["width"], sheet["pixels"][index] // sheet["width"]
    size = stage.size
    ActionChains(browser).move_to_element_with_offset(
        stage, round((x + 0.5) / sheet["width"] * size["width"] - size["width"] / 2),
        round((y + 0.5) / sheet["height"] * size["height"] - size["height"] / 2)).click().perform()
    check_reading(index_of(x, y))

    # Keys, from there on.
    before = where()
    stage.send_keys(Keys.ARROW_RIGHT)
    require(where() != before, "an arrow key does not walk")
    next_odd = closer.find_element(By.CSS_SELECTOR, "[data-walk='1']")
    odd = [i for i in range(len(sheet["pixels"]))
           if any(column(tracer, "class")[i] > 0 for tracer in sheet["tracers"])]
    require(next_odd.is_enabled() == bool(odd), "the buttons do not know whether there is an odd pixel")
    if odd:
        next_odd.send_keys(Keys.ENTER)
        first = int(where().split("odd pixel ")[1].split(" of ")[0].replace(",", "")) - 1
        check_reading(odd[first])
        next_odd.send_keys(Keys.ENTER)
        check_reading(odd[(first + 1) % len(odd)])


def check_page(browser, page):
    """All of it; says what was there."""
    load(browser, page)
    charts = check_charts(browser)
    check_structure(browser)
    check_width(browser)
    check_keyboard(browser)
    check_preferences(browser)
    closers = [c for c in browser.find_elements(By.CSS_SELECTOR, "[data-closer]") if c.is_displayed()]
    inspected = 0
    for closer in closers:
        check_divider(browser, closer)
        if closer.find_element(By.CSS_SELECTOR, ".reading").is_displayed():
            check_inspector(browser, closer)
            inspected += 1
    check_network(browser, page)
    check_console(browser)
    return charts, len(closers), inspected


# ---- The checks themselves are checked.

SABOTAGE = {
    "an error in the console": ("draw();", "draw(); console.error('broken on purpose');"),
    "a request": ("draw();", "draw(); new Image().src = 'http://127.0.0.1:9/pixel.png';"),
    "charts that are not drawn": ("new Chart(plot", "(() => ({ destroy() {}, canvas: plot.querySelector('canvas') }))(plot"),
    "a divider that stands still": ("slider.addEventListener", "void slider.addEventListener.length; (() => {})"),
    "an inspector that is deaf": ('stage.addEventListener("click"', 'stage.addEventListener("dblclick"'),
    "an inspector off by four pixels": ("const c = cost(place);", "const c = cost({ x: place.x - 4, y: place.y });"),
    "the answers of another pixel": ("replaceChildren(...sheet.rows(i))", "replaceChildren(...sheet.rows(i > 0 ? i - 1 : 1))"),
    "focus that cannot be seen": (":focus-visible { outline: 3px solid", ":focus-visible { outline: 0 none"),
    "a heading too deep": ("<h3>", "<h4>"),
    "a picture without a text": (' alt="', ' data-alt="'),
    "no dark page": ("prefers-color-scheme: dark", "prefers-color-scheme: dusk"),
    "motion": ("prefers-reduced-motion: reduce", "prefers-reduced-motion: never"),
}


def check_the_checks(browser, page):
    text = page.read_text(encoding="utf-8")
    unnoticed = []
    with tempfile.TemporaryDirectory() as folder:
        broken = pathlib.Path(folder) / "broken.html"
        for name, (old, new) in SABOTAGE.items():
            require(old in text, f"'{name}' breaks nothing: {old} is not in the page")
            broken.write_text(text.replace(old, new), encoding="utf-8")
            try:
                check_page(browser, broken)
                unnoticed.append(name)
            except AssertionError as noticed:
                print(f"  noticed {name}: {str(noticed)[:90]}")
    require(not unnoticed, f"broken on purpose, and not noticed: {unnoticed}")


def main():
    pages = [pathlib.Path(argument) for argument in sys.argv[1:]]
    require(pages, "no page given")
    browser = open_browser()
    failed, inspected_page, charts_of_all = 0, None, 0
    try:
        for page in pages:
            try:
                charts, closers, inspected = check_page(browser, page)
                charts_of_all += charts
                if inspected and not inspected_page:
                    inspected_page = page
                print(f"passed: {page}: {charts} charts, {closers} dividers, {inspected} inspectors")
            except AssertionError as failure:
                failed += 1
                print(f"FAILED: {page}: {failure}")
        require(charts_of_all > 0, "no page had a chart")
        require(inspected_page or failed, "no page had a pixel inspector")
        if inspected_page:
            check_the_checks(browser, inspected_page)
    finally:
        browser.quit()
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
