"""The web page of `castray compare --html`: pages.py drives it."""
import struct
import subprocess
from xml.etree import ElementTree

WIDTH, HEIGHT = 60, 40


def write_pfm(path, pixel):
    rows = [struct.pack("<3f", *pixel(x, y)) for y in range(HEIGHT - 1, -1, -1) for x in range(WIDTH)]
    path.write_bytes(f"PF\n{WIDTH} {HEIGHT}\n-1.0\n".encode() + b"".join(rows))


def make_page(castray, folder):
    """Three images: 'a' equal, 'm' different, 'z' without an image; the page must show m and z before a."""
    for side in ("image", "reference"):
        (folder / side).mkdir()
        write_pfm(folder / side / "a.pfm", lambda x, y: (0.2, 0.4, 0.6))
    write_pfm(folder / "image" / "m.pfm", lambda x, y: (1.0 + 0.001 * x, 0.0, 0.0))
    write_pfm(folder / "reference" / "m.pfm", lambda x, y: (0.0, 0.0, 0.25))
    write_pfm(folder / "reference" / "z.pfm", lambda x, y: (0.5, 0.5, 0.5))
    page = folder / "page.html"
    run = subprocess.run(
        [castray, "compare", "image", "reference", "--max", "mse=1e-6", "--html", page.name, "--junit", "junit.xml"],
        cwd=folder,
        check=False,
    )
    assert run.returncode == 2, run.returncode
    check_junit(folder / "junit.xml")
    return page


def check_junit(file):
    suite = ElementTree.parse(file).getroot()
    assert suite.tag == "testsuite" and suite.get("name")
    cases = suite.findall("testcase")
    assert [(case.get("name"), [kind.tag for kind in case]) for case in cases] == [
        ("a.pfm", []), ("m.pfm", ["failure"]), ("z.pfm", ["error"])]
    assert all(case.get("classname") and all(kind.get("message") and kind.text for kind in case) for case in cases)
    counts = {name: int(suite.get(name)) for name in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": 3, "failures": 1, "errors": 1, "skipped": 0}, counts


def colour(page, x, y):
    return page.evaluate(
        "([x, y]) => [...document.querySelector('canvas').getContext('2d').getImageData(x, y, 1, 1).data]", [x, y]
    )


def set_slider(page, name, value):
    page.locator(f"[data-slider={name}]").first.evaluate(
        "(input, value) => { input.value = value; input.dispatchEvent(new Event('input')); }", value
    )


def check_order(page):
    names = page.locator("h2").all_inner_texts()
    assert names == ["m.pfm", "z.pfm", "a.pfm"], names
    assert page.locator("details").nth(0).get_attribute("open") is not None
    assert page.locator("details").nth(2).get_attribute("open") is None
    assert "1 differ, 1 cannot be compared, 1 pass" in page.inner_text("#summary")


def check_swipe(page):
    assert colour(page, 10, 5)[0] == 255 and colour(page, 50, 5)[0] == 0  # image left, reference right
    assert colour(page, WIDTH - 1, HEIGHT - 1) == [0, 0, 137, 255]
    set_slider(page, "swipe", 10)
    assert colour(page, 10, 5)[0] == 0
    page.locator(".stage").first.focus()
    for _ in range(45):
        page.keyboard.press("ArrowRight")
    assert colour(page, 50, 5)[0] == 255
    box = page.locator("canvas").first.bounding_box()
    page.mouse.click(box["x"] + box["width"] * 0.25, box["y"] + 20)
    assert colour(page, 10, 5)[0] == 255 and colour(page, 50, 5)[0] == 0


def check_flip(page):
    page.mouse.move(2, 2)
    page.keyboard.press("2")
    assert colour(page, 50, 5)[0] == 255
    page.locator("canvas").first.hover()
    assert colour(page, 50, 5)[:3] == [0, 0, 137]
    page.mouse.move(2, 2)
    assert colour(page, 50, 5)[0] == 255
    page.keyboard.press(" ")
    assert colour(page, 50, 5)[0] == 0
    page.keyboard.press(" ")


def check_values_and_zoom(page):
    before = page.locator("canvas").first.bounding_box()
    page.keyboard.press("+")
    after = page.locator("canvas").first.bounding_box()
    assert abs(after["width"] - 2 * before["width"]) < 1
    page.keyboard.press("-")
    scale = before["width"] / WIDTH
    page.locator("canvas").first.hover(position={"x": 30.5 * scale, "y": 7.5 * scale})
    text = page.locator(".values").first.inner_text()
    assert "(30,7)" in text and " 1.03 " in text and " 0.250\n" in text and " -0.250" in text, text


def check_exposure(page):
    page.keyboard.press("2")
    page.mouse.move(2, 2)
    set_slider(page, "exposure", -2)
    assert abs(colour(page, 0, 5)[0] - 137) <= 1  # 1/4 of full, by the sRGB curve
    page.keyboard.press("e")
    assert abs(colour(page, 0, 5)[0] - 159) <= 30 and colour(page, 0, 5)[0] > 140
    set_slider(page, "exposure", 0)


def check_heat_map(page):
    """Also that nothing moves: the image keeps its place, and so do the buttons."""
    places = [page.locator("canvas").first, page.locator("[data-mode=heat]").first, page.locator(".stage").first]
    before = [place.bounding_box() for place in places]
    page.keyboard.press("3")
    heat = page.locator("img").first
    assert heat.is_visible() and not page.locator("canvas").first.is_visible()
    assert heat.evaluate("image => image.naturalHeight") > HEIGHT  # the colour bar is below
    error, image = heat.bounding_box(), before[0]
    assert abs(error["x"] - image["x"]) < 1 and abs(error["y"] - image["y"]) < 1, (error, image)
    for place, was in list(zip(places, before))[1:]:
        box = place.bounding_box()
        assert abs(box["x"] - was["x"]) < 1 and abs(box["y"] - was["y"]) < 1 and abs(box["width"] - was["width"]) < 1
    page.keyboard.press("1")


def check_rest(page):
    page.keyboard.press("j")  # z.pfm, which has no picture
    page.locator("summary").nth(2).click()
    thumbnail = page.locator("details:nth-of-type(3) .thumbnail")  # a.pfm, which passes
    thumbnail.wait_for()
    assert thumbnail.evaluate("image => image.naturalWidth") == WIDTH and page.locator("canvas").count() == 1
    commands = page.locator(".command code").all_inner_texts()
    assert "castray accept image/m.pfm reference/m.pfm" in commands, commands
    row = page.locator("tr.exceeds").first.inner_text()
    assert row.startswith("mse") and "<= 1e-06" in row, row


def check_narrow(page):
    for button in page.locator("button").all():
        assert not button.is_visible() or button.bounding_box()["height"] >= 36


def check(page, kind):
    check_order(page)
    check_narrow(page)
    if kind == "desktop":
        for part in (check_swipe, check_flip, check_values_and_zoom, check_exposure, check_heat_map, check_rest):
            part(page)
