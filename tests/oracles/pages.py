#!/usr/bin/env python3
"""Drives the web pages that castray writes and serves in headless Chromium, on a desktop and a phone, light and dark:
pages.py CASTRAY [SCREENSHOT_FOLDER]."""
import pathlib
import shutil
import sys
import tempfile

import bench_page
import compare_page
import serve_page
from playwright.sync_api import sync_playwright

SCREENS = [("desktop", (1280, 900), "light"), ("phone", (390, 844), "light"), ("dark", (1280, 900), "dark"),
           ("dark-phone", (390, 844), "dark")]


def luminance(css):
    r, g, b = (int(v) for v in css[css.index("(") + 1 : css.index(")")].split(",")[:3])
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def check_colours(page, scheme):
    body = page.evaluate("(s => [s.backgroundColor, s.color])(getComputedStyle(document.body))")
    paper, ink = (luminance(css) for css in body)
    assert (paper < 60 and ink > 180) if scheme == "dark" else (paper > 200 and ink < 60)


def check_width(page):
    overflow = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert overflow <= 0, f"the page is {overflow} pixels wider than the screen"


def drive(browser, address, check, pictures, name):
    """Opens the page on each screen, offline unless it is served. Errors of scripts and requests of other addresses are
    faults."""
    served = address.startswith("http:")
    own = (address,) if served else ("file:", "data:", "blob:")
    problems = []
    for kind, size, scheme in SCREENS:
        context = browser.new_context(viewport={"width": size[0], "height": size[1]}, color_scheme=scheme, offline=not served,
                                      has_touch=kind.endswith("phone"))
        page = context.new_page()
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("console", lambda message: message.type == "error" and problems.append(message.text))
        page.on("request", lambda request: request.url.startswith(own) or problems.append(request.url))
        page.goto(address)
        if name == "compare":
            page.wait_for_selector("[data-ready=yes]")
        if name == "serve":
            page.wait_for_function("() => document.getElementById('canvas').width > 1")
        if pictures:
            page.screenshot(path=pictures / f"{name}-{kind}.png", full_page=True)
        check_colours(page, scheme)
        check_width(page)
        check(page, kind)
        context.close()
    assert not problems, problems


def main():
    castray = str(pathlib.Path(sys.argv[1]).resolve())
    pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-dev-shm-usage"])
        for module in (compare_page, bench_page):
            folder = pathlib.Path(name) / module.__name__
            folder.mkdir()
            address = module.make_page(castray, folder).as_uri()
            drive(browser, address, module.check, pictures, module.__name__.removesuffix("_page"))
        with serve_page.Served(castray, pathlib.Path(name)) as served:
            drive(browser, served.address, served.check, pictures, "serve")
    print("the pages work")


if __name__ == "__main__":
    main()
