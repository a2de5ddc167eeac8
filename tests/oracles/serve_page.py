"""The web page of `castray serve`: pages.py drives it."""
import json
import pathlib
import re
import signal
import subprocess

SIZE = 96
LAMP = (SIZE // 2, 13)  # a pixel of the Cornell box's light
RADIANCE = (47.835, 38.566, 31.081)  # of the light, which is all that --max-depth 1 shows


class Served:
    """A running `castray serve` of the Cornell box."""

    def __init__(self, castray, folder):
        self.castray, self.folder = castray, folder
        scene = pathlib.Path(__file__).parents[2] / "scenes" / "cornell_box.json"
        self.process = subprocess.Popen(
            [castray, "serve", scene, "--size", f"{SIZE}x{SIZE}", "--max-depth", "1", "--threads", "1"],
            stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", self.address), self.address

    def check(self, page, kind):
        page.wait_for_function("() => document.getElementById('status').textContent.includes('samples per pixel')")
        assert page.evaluate("[...document.querySelectorAll('button, .button')].every(b => b.offsetHeight >= 36)")
        if kind == "phone":
            check_touch(page)
        if kind == "desktop":
            for part in (check_exposure, check_values, check_convergence, check_mouse, check_keys, check_part):
                part(page)
            self.check_saved(page)

    def check_saved(self, page):
        """The page's own flags, given to `castray render`, make the image that it saves."""
        page.locator("#home").click()
        wait_for_flags(page, "--look-from 278,273,-800 ")
        for suffix in ("exr", "png"):
            with page.expect_download() as download:
                page.locator(f"#save-{suffix}").click()
            assert download.value.suggested_filename == f"cornell_box.{suffix}"
            download.value.save_as(self.folder / f"saved.{suffix}")
        subprocess.run([self.castray, "render", pathlib.Path(__file__).parents[2] / "scenes" / "cornell_box.json",
                        "--size", f"{SIZE}x{SIZE}", "--max-depth", "1", "--spp", "64", "-q", "-o", "again.exr",
                        *page.inner_text("#flags").split()], cwd=self.folder, check=True)
        subprocess.run([self.castray, "compare", "saved.exr", "again.exr", "--max", "relmse=0.01"], cwd=self.folder,
                       check=True, stdout=subprocess.DEVNULL)
        assert json.loads(f"{{{page.inner_text('#json')}}}")["camera"]["position"] == [278, 273, -800]

    def __enter__(self):
        return self

    def __exit__(self, failure, *_):
        """Ctrl-C ends it."""
        self.process.send_signal(signal.SIGINT)
        assert self.process.wait(timeout=30) == 0 or failure


def status(page):
    return page.inner_text("#status")


def wait_for_flags(page, text):
    page.wait_for_function("text => document.getElementById('flags').textContent.includes(text)", arg=text)


def samples(page):
    return float(re.search(r"([\d.]+) samples? per pixel", status(page))[1])


def colour(page, pixel):
    return page.evaluate("([x, y]) => [...document.getElementById('canvas').getContext('2d')"
                         ".getImageData(x, y, 1, 1).data]", list(pixel))


def point(page, pixel):
    """Where a pixel of the picture is on the screen."""
    box = page.locator("#canvas").bounding_box()
    return box["x"] + (pixel[0] + 0.5) / SIZE * box["width"], box["y"] + (pixel[1] + 0.5) / SIZE * box["height"]


def drag(page, begin, end):
    page.mouse.move(*point(page, begin))
    page.mouse.down()
    page.mouse.move(*point(page, end), steps=4)
    page.mouse.up()


def eye(page):
    """Position and distance from what is looked at; that is told as far away as the middle of the scene, or nearly."""
    text = page.inner_text("#flags")
    position, target = ([float(v) for v in re.search(f"--{name} (\\S+)", text)[1].split(",")]
                        for name in ("look-from", "look-at"))
    return position, sum((a - b) ** 2 for a, b in zip(position, target)) ** 0.5


def check_exposure(page):
    assert colour(page, LAMP) == [255, 255, 255, 255] and colour(page, (5, 90)) == [0, 0, 0, 255]
    page.locator("#exposure").evaluate("(input) => { input.value = -6; input.dispatchEvent(new Event('input')); }")
    expected = [255 * (1.055 * (v / 64) ** (1 / 2.4) - 0.055) for v in RADIANCE]
    assert all(abs(a - b) <= 1 for a, b in zip(colour(page, LAMP), expected)), (colour(page, LAMP), expected)
    page.keyboard.press("e")
    assert page.inner_text("#stops") == "-5.75 stops"
    page.locator("#exposure").evaluate("(input) => { input.value = 0; input.dispatchEvent(new Event('input')); }")


def check_values(page):
    page.mouse.move(*point(page, LAMP))
    text = page.inner_text("#values")
    assert f"({LAMP[0]},{LAMP[1]})" in text and all(f"{v:.3f}" in text for v in RADIANCE), text


def check_convergence(page):
    before = samples(page)
    page.wait_for_function("n => parseFloat(document.getElementById('status').textContent.split(' · ')[1]) > n", arg=before)
    page.keyboard.press(" ")
    page.wait_for_function("() => document.getElementById('status').textContent.includes('paused')")
    page.wait_for_timeout(700)  # a frame that was under way
    before = samples(page)
    page.wait_for_timeout(700)
    assert samples(page) == before
    page.locator("#pause").click()
    page.wait_for_function("n => parseFloat(document.getElementById('status').textContent.split(' · ')[1]) > n", arg=before)


def check_mouse(page):
    position, distance = eye(page)
    assert position == [278, 273, -800]
    before = samples(page)
    drag(page, (48, 48), (24, 40))
    page.wait_for_function("() => !document.getElementById('flags').textContent.includes('278,273,-800')")
    page.wait_for_timeout(300)
    position, now = eye(page)
    assert abs(now - distance) < 1 and position[1] < 273 and abs(position[0] - 278) > 100, (position, now)
    assert samples(page) < before  # it begins anew
    page.mouse.wheel(0, -120)
    page.wait_for_timeout(300)
    assert 0.8 < eye(page)[1] / distance < 0.9, eye(page)


def check_keys(page):
    page.keyboard.press("h")
    wait_for_flags(page, "--look-from 278,273,-800 ")
    distance = eye(page)[1]
    page.keyboard.press("ArrowLeft")
    page.wait_for_function("() => !document.getElementById('flags').textContent.includes('278,273,-800')")
    assert abs(eye(page)[1] - distance) < 1
    page.keyboard.press("]")
    wait_for_flags(page, "--fov 42")
    page.keyboard.press("h")
    wait_for_flags(page, "--look-from 278,273,-800 ")


def check_part(page):
    page.keyboard.press("c")
    drag(page, (40, 5), (60, 20))
    page.wait_for_function("() => document.getElementById('status').textContent.includes('in the part')")
    assert page.locator("#frame").is_visible()
    before = samples(page)
    page.wait_for_function("n => parseFloat(document.getElementById('status').textContent.split(' · ')[1]) > n", arg=before)
    assert colour(page, LAMP)[0] == 255 and colour(page, (5, 90)) == [0, 0, 0, 255]
    page.keyboard.press("Escape")
    page.wait_for_function("() => !document.getElementById('status').textContent.includes('in the part')")
    assert page.locator("#frame").is_hidden()


def check_touch(page):
    """Two fingers that part bring the camera nearer, one turns it."""
    devtools = page.context.new_cdp_session(page)
    distance = eye(page)[1]
    x, y = point(page, (48, 48))

    def touch(kind, points):
        devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [
            {"x": px, "y": py, "id": i} for i, (px, py) in enumerate(points)]})

    touch("touchStart", [(x - 30, y), (x + 30, y)])
    touch("touchMove", [(x - 60, y), (x + 60, y)])
    touch("touchEnd", [])
    page.wait_for_function("() => !document.getElementById('flags').textContent.includes('278,273,-800')")
    page.wait_for_timeout(300)
    nearer, distance_now = eye(page)
    assert distance_now < 0.7 * distance, (distance, distance_now)
    touch("touchStart", [(x, y)])
    touch("touchMove", [(x + 40, y)])
    touch("touchEnd", [])
    page.wait_for_timeout(500)
    turned = eye(page)[0]
    assert sum((a - b) ** 2 for a, b in zip(turned, nearer)) ** 0.5 > 100, (nearer, turned)
    page.locator("#home").click()
    wait_for_flags(page, "--look-from 278,273,-800 ")
