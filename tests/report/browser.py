"""Pages in a real browser, headless: browser.py OUT PAGE.html … opens each, drives what can be driven, and leaves pictures in OUT.

It fails on an error of the console, a request to anything but the page itself, a page wider than a phone, a control that does nothing. What it
cannot judge, whether a page is good to read, is for a person: OUT/NAME-light.png, -dark.png, -phone.png, -print.pdf and its pages."""
import base64
import json
import os
import pathlib
import subprocess
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

PAGE_HEIGHT_MOST = 16000  # of a screenshot, pixels


def start():
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for argument in ("--headless=new", "--disable-gpu", "--hide-scrollbars", "--force-color-profile=srgb", *(["--no-sandbox"] if os.getuid() == 0 else [])):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


class Visit:
    def __init__(self, driver, page, out):
        self.driver, self.page, self.out, self.faults = driver, page, out, []
        self.name = f"{page.resolve().parent.name}-{page.stem}"

    def check(self, holds, what):
        if not holds:
            self.faults.append(what)

    def command(self, name, **arguments):
        return self.driver.execute_cdp_cmd(name, arguments)

    def view(self, width, scheme, height=900):
        self.command("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.command("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        time.sleep(.4)

    def script(self, text, *arguments):
        return self.driver.execute_script(text, *arguments)

    def picture(self, what, width, scheme):
        self.view(width, scheme)
        self.view(width, scheme, min(self.script("return document.documentElement.scrollHeight"), PAGE_HEIGHT_MOST))
        shot = self.command("Page.captureScreenshot", format="png")["data"]
        (self.out / f"{self.name}-{what}.png").write_bytes(base64.b64decode(shot))
        # What is too wide scrolls by itself; the page does not.
        self.check(self.script("return document.documentElement.scrollWidth") <= width, f"the page is wider than {width} pixels ({what})")

    def print(self):
        pdf = self.out / f"{self.name}-print.pdf"
        pdf.write_bytes(base64.b64decode(self.command("Page.printToPDF", printBackground=False, preferCSSPageSize=True)["data"]))
        subprocess.run(["pdftoppm", "-r", "80", "-png", str(pdf), str(pdf.with_suffix(""))], check=True)

    def drive_comparer(self, comparer):
        stage = comparer.find_element(By.CLASS_NAME, "stage")
        slider = comparer.find_element(By.CSS_SELECTOR, "input[type=range]")
        flip = comparer.find_element(By.TAG_NAME, "button")

        def at():
            return self.script("return arguments[0].style.getPropertyValue('--at')", stage)
        self.script("arguments[0].scrollIntoView({block: 'center'})", stage)
        before = at()
        slider.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.check(at() != before, "the slider does not follow the keyboard")
        webdriver.ActionChains(self.driver).move_to_element_with_offset(stage, -40, 0).click().perform()
        self.check(float(at().rstrip("%")) < 50, "the slider does not follow the pointer")
        flip.click()
        self.check(at() == "0%" and flip.get_attribute("aria-pressed") == "true", "flip does not show the right picture")
        flip.click()
        self.check(at() == "100%" and flip.get_attribute("aria-pressed") == "false", "flip does not show the left picture")
        for radio in comparer.find_elements(By.CSS_SELECTOR, "input[type=radio]"):
            radio.click()
            over = self.script("return arguments[0].querySelectorAll('.pic')[1].className", stage)
            self.check(f" {radio.get_attribute('value')[0]}" in over or " p" in over, f"{radio.get_attribute('value')} is not shown")
            image = self.script("return getComputedStyle(arguments[0].querySelectorAll('.pic')[1]).backgroundImage", stage)
            self.check(image.startswith('url("data:image/'), f"{radio.get_attribute('value')} has no picture")
        right = Select(comparer.find_elements(By.TAG_NAME, "select")[1])
        right.select_by_index(0)
        self.check(self.script("return arguments[0].querySelectorAll('.name')[1].textContent", stage) == right.options[0].text, "the choice is not shown")
        alternate = comparer.find_element(By.CSS_SELECTOR, "input[type=checkbox]")
        alternate.click()
        seen = {at()}
        for _ in range(10):
            time.sleep(.2)
            seen.add(at())
        self.check({"0%", "100%"} <= seen, "alternate does not alternate")
        alternate.click()

    def drive_charts(self):
        def drawn(canvas):
            return self.script("return arguments[0].toDataURL()", canvas)
        for box in self.driver.find_elements(By.CSS_SELECTOR, "[data-chart=errors]"):
            if not box.find_elements(By.TAG_NAME, "canvas"):
                self.check(False, "there are no plots: is Chart.js on the page?")
                return
            canvas = box.find_element(By.TAG_NAME, "canvas")
            self.script("arguments[0].scrollIntoView({block: 'center'})", canvas)
            views = [select for select in box.find_elements(By.TAG_NAME, "select") if select.get_attribute("aria-label") == "view"]
            for view in range(len(Select(views[0]).options) if views else 1):
                if views:
                    Select(views[0]).select_by_index(view)
                self.drive_errors(box, canvas, drawn)
        blank = self.script("""return [...document.querySelectorAll("canvas")].filter((c) =>
            !c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some((v) => v)).length""")
        self.check(blank == 0, f"{blank} plots are empty")

    def drive_errors(self, box, canvas, drawn):
        """One view's plot. A study whose pictures are all black or all right has nothing to draw, and says so."""
        def point():
            return self.script("""const chart = Chart.getChart(arguments[0]);
                const set = chart.data.datasets.findIndex((d) => d.data.some((p) => p.point));
                if (set < 0)
                    return null;
                const p = chart.getDatasetMeta(set).data[chart.data.datasets[set].data.findIndex((d) => d.point)];
                return [p.x - canvas.clientWidth / 2, p.y - canvas.clientHeight / 2];""".replace("canvas.", "arguments[0]."), canvas)
        figure, last, empty = Select(box.find_element(By.TAG_NAME, "select")), None, False
        for index in [*range(1, len(figure.options)), 0]:
            figure.select_by_index(index)
            nothing = point() is None
            self.check(nothing == ("nothing to draw" in box.text), f"the plot of {figure.options[index].text} does not say whether it is empty")
            self.check(nothing or empty or drawn(canvas) != last, f"the plot of {figure.options[index].text} is that of the one before")
            last, empty = drawn(canvas), nothing
        at = point()
        if at is None:
            return
        bands = box.find_element(By.CSS_SELECTOR, "input[type=checkbox]")
        banded = self.script("return Chart.getChart(arguments[0]).data.datasets.some((d) => d.fill === '-1')", canvas)
        bands.click()
        self.check(not banded or drawn(canvas) != last, "bands stay when they are switched off")
        bands.click()
        webdriver.ActionChains(self.driver).move_to_element_with_offset(canvas, *map(round, at)).perform()
        time.sleep(.3)
        self.check("candil render" in box.text, "pointing at a point does not tell its command")

    def labels(self):
        bare = self.script("""return [...document.querySelectorAll("select, input, button, canvas, [role=img]")].filter((e) =>
            !e.getAttribute("aria-label") && !e.closest("label") && !e.textContent.trim()).map((e) => e.outerHTML.slice(0, 90))""")
        self.check(not bare, f"without a label: {bare[:3]}")

    def logs(self):
        for entry in self.driver.get_log("browser"):
            self.check(False, f"console: {entry['message']}")
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                url = message["params"]["request"]["url"]
                self.check(url == self.page.resolve().as_uri() or url.startswith(("data:", "blob:")), f"a request to {url[:80]}")

    def run(self):
        self.view(1200, "light")
        self.driver.get(self.page.resolve().as_uri())
        time.sleep(1)
        self.picture("light", 1200, "light")
        self.picture("dark", 1200, "dark")
        self.picture("phone", 390, "light")
        self.view(1200, "light")
        self.print()
        self.labels()
        self.drive_charts()
        for comparer in self.driver.find_elements(By.CLASS_NAME, "comparer")[:2]:
            self.drive_comparer(comparer)
        self.logs()
        return self.faults


def main():
    out, pages = pathlib.Path(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
    out.mkdir(parents=True, exist_ok=True)
    driver, failed = start(), 0
    try:
        for page in pages:
            faults = Visit(driver, page, out).run()
            print(f"{page}: {'; '.join(faults) or 'as it should be'}")
            failed += bool(faults)
    finally:
        driver.quit()
    return 1 if failed or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
