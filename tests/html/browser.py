"""A headless Chromium that pages are tested in: software drawing, no network."""
import time
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

CHROMIUM = ("/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome")
DRIVER = ("/usr/bin/chromedriver", "/usr/lib/chromium-browser/chromedriver")


def found(paths):
    return next((p for p in paths if Path(p).exists()), None)


def is_missing():
    return not (found(CHROMIUM) and found(DRIVER))


def start(dark=False, size=(1366, 768)):
    options = Options()
    options.binary_location = found(CHROMIUM)
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                     "--disable-background-networking", "--disable-component-update", "--force-prefers-reduced-motion",
                     "--host-resolver-rules=MAP * ~NOTFOUND", f"--window-size={size[0]},{size[1]}"):
        options.add_argument(argument)
    if dark:
        options.add_argument("--force-dark-mode")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(service=Service(found(DRIVER)), options=options)
    driver.set_page_load_timeout(60)
    driver.set_script_timeout(60)
    return driver


def block_network(driver):
    driver.execute_cdp_cmd("Network.enable", {})
    driver.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0})


def open_page(driver, path, seconds=60):
    """Opens a page and waits until it is drawn; returns its seconds to the first frame."""
    driver.get(Path(path).resolve().as_uri())
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        state = driver.execute_script("return window.burnish ? [burnish.ready, burnish.failed || null, burnish.firstFrame] : null")
        if state and state[1]:
            raise AssertionError(f"{path}: the page says: {state[1]}")
        if state and state[0]:
            return state[2] / 1000
        time.sleep(0.05)
    raise AssertionError(f"{path}: nothing drawn after {seconds} s: {driver.get_log('browser')}")
