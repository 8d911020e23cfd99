"""The pages, and the blocks of code in them."""
import glob
import os
import re

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGES = sorted([os.path.join(PACKAGE, name) for name in ('README.md', 'CONTRIBUTING.md')] +
               glob.glob(os.path.join(PACKAGE, 'doc', '*.md')) +
               glob.glob(os.path.join(PACKAGE, 'src', '**', '*.md'), recursive=True))


def text_of(page):
    with open(page, encoding='utf-8') as file:
        return file.read()


def name_of(page):
    return os.path.relpath(page, PACKAGE)


class Block:
    """A fenced block. `mark` is what the HTML comment in front says: "run", "check", "check: a camera", "output"."""

    def __init__(self, page, mark, language, text):
        self.page, self.mark, self.language, self.text = name_of(page), mark, language, text

    def lines(self):
        """Commands, continued ones joined, without comments of a line's own."""
        joined = self.text.replace('\\\n', ' ')
        return [line for line in joined.splitlines() if line.strip() and not line.lstrip().startswith('#')]


def blocks():
    found = []
    pattern = re.compile(r'(?:<!-- (?P<mark>[^>]*) -->\n)?```(?P<language>\w*)\n(?P<text>.*?)\n?```', re.DOTALL)
    for page in PAGES:
        for match in pattern.finditer(text_of(page)):
            found.append(Block(page, match['mark'], match['language'], match['text']))
    return found
