"""
A real browser, and what tests ask of a page in it.

Modules that import this one are skipped where selenium is missing. Without chromium and its driver
(Debian: chromium, chromium-driver) the tests that open a browser are.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
import shutil
from typing import Any

from matplotlib.colors import to_rgb
import numpy as np
from PIL import Image
import pytest

webdriver = pytest.importorskip('selenium.webdriver', reason='needs selenium')
from selenium.webdriver.chrome.service import Service  # noqa: E402
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402

__all__ = ['ActionChains', 'BrowserPage', 'Keys', 'open_browser']

OPTIONS = (
    '--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --window-size=1400,860 '
    '--disable-background-networking --disable-component-update --disable-sync '
    '--host-resolver-rules=MAP\u00a0*\u00a0~NOTFOUND,EXCLUDE\u00a0127.0.0.1'
)
PATIENCE = 60.0


@contextmanager
def open_browser() -> Iterator[Any]:
    """Run a browser that resolves no names, so that it reaches this machine only."""
    programs = [shutil.which(name) for name in ('chromium', 'chromedriver')]
    if None in programs:
        pytest.skip('needs chromium and chromedriver')
    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    for option in OPTIONS.split(' '):
        options.add_argument(option.replace('\u00a0', ' '))
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL'})
    driver = webdriver.Chrome(options=options, service=Service(programs[1]))
    try:
        yield driver
    finally:
        driver.quit()


class BrowserPage:
    """A page in the browser."""

    def __init__(self, browser: Any, address: str) -> None:
        """Open the page."""
        self.browser = browser
        browser.get_log('browser')
        browser.get(address)

    def errors(self) -> list[str]:
        """Return the errors since the page was opened."""
        return [line['message'] for line in self.browser.get_log('browser')]

    def find(self, selector: str) -> Any:
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def text(self, selector: str) -> str:
        return str(self.find(selector).text)

    def time(self) -> int:
        return int(self.find('#time').get_property('value'))

    def press(self, *keys: str) -> None:
        """Press keys, whatever has the focus."""
        ActionChains(self.browser).send_keys(*keys).perform()

    def wait(self, until: Callable[[], bool]) -> None:
        WebDriverWait(self.browser, PATIENCE, 0.05).until(lambda _: until())

    def pause(self) -> None:
        button = self.find('#play')
        if button.get_attribute('aria-label') == 'Pause':
            button.click()

    def go_to(self, key: str) -> None:
        """Press Home or End on the slider."""
        self.pause()
        self.find('#time').send_keys(key)

    def pixels(self) -> np.ndarray:
        """Return the colours (rows, columns, 3) of the canvas, once it is drawn."""
        url = self.browser.execute_async_script(
            'const done = arguments[0];'
            'requestAnimationFrame(() => requestAnimationFrame(() =>'
            "  done(document.getElementById('view').toDataURL())));"
        )
        written = base64.b64decode(url.partition(',')[2])
        return np.asarray(Image.open(BytesIO(written)).convert('RGB'), dtype=int)

    def has(self, colour: str) -> bool:
        """Return whether a colour covers more than a few pixels."""
        wanted = np.round(255 * np.array(to_rgb(colour)))
        return int((np.abs(self.pixels() - wanted).max(axis=2) <= 3).sum()) > 150
