"""A headless Chromium, driven through its DevTools protocol over a pipe."""

import json
import os
import select
import subprocess
import tempfile
import time

BOUND = 600  # seconds, for each wait: too long for any busy machine


class Browser:
    """One browser with one page, which reaches no host but this one."""

    def __init__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self.requests = os.pipe()
        self.replies, from_browser = os.pipe()
        # Chromium reads requests from descriptor 3 and writes replies to 4.
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec chromium "$@" 3<&{to_browser} 4>&{from_browser}', "chromium", "--headless",
             "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", f"--user-data-dir={self.profile.name}",
             "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--remote-debugging-pipe"],
            pass_fds=(to_browser, from_browser), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.buffer = 0, b""
        target = self.call("Target.createTarget", {"url": "about:blank"})["targetId"]
        self.session = self.call("Target.attachToTarget", {"targetId": target, "flatten": True})["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        os.close(self.requests)
        os.close(self.replies)
        self.profile.cleanup()

    def message(self):
        """The browser's next message. Raises TimeoutError if there is none within BOUND."""
        while b"\0" not in self.buffer:
            if not select.select([self.replies], [], [], BOUND)[0]:
                raise TimeoutError(f"chromium has sent nothing for {BOUND} s")
            more = os.read(self.replies, 1 << 16)
            if not more:
                raise ConnectionError(f"chromium has ended, exit code {self.process.wait()}")
            self.buffer += more
        text, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(text)

    def call(self, method, parameters=None):
        """The result of a method of the protocol."""
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters or {}}
        if hasattr(self, "session"):
            request["sessionId"] = self.session
        os.write(self.requests, json.dumps(request).encode() + b"\0")
        while True:
            reply = self.message()
            if reply.get("id") == self.number:
                if "error" in reply:
                    raise RuntimeError(f"{method}: {reply['error']}")
                return reply["result"]

    def evaluate(self, expression):
        """The value of an expression of JavaScript in the page."""
        result = self.call("Runtime.evaluate", {"expression": expression, "returnByValue": True})
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait_for(self, expression):
        """Whether an expression becomes true within BOUND."""
        end = time.monotonic() + BOUND
        while time.monotonic() < end:
            if self.evaluate(expression):
                return True
            time.sleep(0.05)
        return False

    def open(self, address):
        """Opens a page; returns whether it has been loaded."""
        self.call("Page.navigate", {"url": address})
        return self.wait_for(f"location.href === {json.dumps(address)} && document.readyState === 'complete'")
