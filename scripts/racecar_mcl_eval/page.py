"""A page that opens from disk: one HTML file with its figures inside, and the same PNGs beside it."""
import base64
import shlex
import sys
from dataclasses import dataclass, field
from pathlib import Path

import jinja2

from . import style


@dataclass
class Cell:
    text: str
    level: str = ""  # good, doubtful or bad, where the figure is judged


@dataclass
class Banner:
    name: str
    level: str
    headline: str
    reasons: list = field(default_factory=list)


class Section:
    def __init__(self, page, title):
        self._page = page
        self.title = title
        self.parts = []

    def text(self, text):
        self.parts.append({"kind": "text", "text": text})

    def table(self, header, rows, caption=""):
        """Cells may be anything that has a text, or a Cell."""
        rows = [[cell if isinstance(cell, Cell) else Cell(str(cell)) for cell in row] for row in rows]
        self.parts.append({"kind": "table", "header": header, "rows": rows, "caption": caption})

    def figure(self, figure, name, caption, commands=()):
        """Writes `name`.png beside the page and takes it in."""
        path = self._page.folder / f"{name}.png"
        style.save(figure, path)
        self._page.figures += 1
        self.parts.append({
            "kind": "figure", "file": name, "number": self._page.figures, "caption": caption,
            "image": base64.b64encode(path.read_bytes()).decode(), "commands": list(commands)})


class Page:
    """`folder` is made if it is not there; `write` puts index.html into it."""

    def __init__(self, folder, title, subtitle):
        self.folder = Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.title = title
        self.subtitle = subtitle
        self.banners = []
        self.sections = []
        self.figures = 0
        self.footer = "Made by:"
        self.command = " ".join(shlex.quote(word) for word in sys.argv)

    def section(self, title):
        self.sections.append(Section(self, title))
        return self.sections[-1]

    def write(self):
        """Returns the page's path."""
        environment = jinja2.Environment(loader=jinja2.FileSystemLoader(str(Path(__file__).parent)),
                                         autoescape=True, trim_blocks=True, lstrip_blocks=True)
        path = self.folder / "index.html"
        path.write_text(environment.get_template("page.html.j2").render(page=self), encoding="utf-8")
        return path
