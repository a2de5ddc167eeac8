"""The web page of `castray bench --html`: pages.py drives it."""
import subprocess

SIDE = 48


def make_page(castray, folder):
    """Two configurations of one scene of this project, and a scene of one budget's worth of both."""
    scene = folder / "box.json"
    (folder / "quad.obj").write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")
    scene.write_text(
        '{ "environment": { "radiance": [1, 1, 1] }, "meshes": [ { "obj": "quad.obj", "transform": ['
        ' { "rotate": [1, 0, 0, -90] } ] }, { "obj": "quad.obj" } ] }'
    )
    page = folder / "bench.html"
    subprocess.run(
        [castray, "bench", scene.name, "--size", f"{SIDE}x{SIDE}", "--spp", "1,4,16", "--seeds", "2", "-q",
         "--reference-spp", "64", "--cache", "cache", "--config", "shared paths=--reuse 8x8:64", "--config",
         "plain paths=--reuse off", "--html", page.name],
        cwd=folder, check=True, stdout=subprocess.DEVNULL,
    )
    return page


def check_plot(page, kind):
    """Its text can be read, and stays within the plot."""
    plot = page.locator("svg").first.bounding_box()
    assert plot["width"] <= page.viewport_size["width"]
    for text in page.locator("svg text").all():
        box = text.bounding_box()
        assert box["x"] >= plot["x"] - 1 and box["x"] + box["width"] <= plot["x"] + plot["width"] + 1, (kind, box)
    heights = page.evaluate(
        "[...document.querySelectorAll('svg text')].map(t => "
        "parseFloat(getComputedStyle(t).fontSize) * t.getScreenCTM().a)")
    assert min(height for height in heights if height > 0) >= 8, min(heights)


def check_pictures(page):
    """Of each configuration and the reference the whole image, and within its frame the part shown enlarged."""
    whole = page.locator(".whole img")
    assert whole.count() == 3
    for image in whole.all():
        assert image.evaluate("image => [image.naturalWidth, image.naturalHeight]") == [SIDE, SIDE]
    outer, frame = whole.first.bounding_box(), page.locator(".whole span").first.bounding_box()
    part = page.locator("img.part").first.evaluate("image => image.naturalWidth")
    assert abs(frame["width"] / outer["width"] - part / SIDE) < 0.02
    assert outer["x"] <= frame["x"] and frame["x"] + frame["width"] <= outer["x"] + outer["width"] + 1


def check(page, kind):
    assert page.locator("h2").all_inner_texts() == ["box"]
    check_plot(page, kind)
    check_pictures(page)
