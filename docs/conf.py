"""Sphinx makes the site of these pages:  make -C docs

Everything on the site is local, formulas too: KaTeX and its fonts are Debian's package libjs-katex.
"""

import re
import sys
from pathlib import Path

from docutils import nodes

sys.path.insert(0, str(Path(__file__).parents[1] / "pipelines"))  # the package of api.md

project = "jointcreep"
release = re.search(r"VERSION (\S+)", (Path(__file__).parents[1] / "CMakeLists.txt").read_text().split("project(")[1])[1]
extensions = ["myst_parser", "sphinx.ext.autodoc"]
autodoc_member_order = "bysource"
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
nitpicky = True
nitpick_ignore = [("py:class", "numpy.ndarray")]  # types of fields
smartquotes_action = "qe"  # two hyphens are an option of a program, no dash

html_theme = "furo"
html_title = f"jointcreep {release}"
html_static_path = ["/usr/share/javascript/katex", "site.css", "site.js"]
html_css_files = ["katex.min.css", "site.css"]
html_js_files = ["katex.min.js", "site.js"]
html_copy_source = False
html_show_copyright = False
html_math_renderer = "katex"


def formula(tag):
    """Writes a formula as LaTeX into a tag of the class math; site.js typesets it."""

    def write(translator, node):
        translator.body.append(f'<{tag} class="math">{translator.encode(node.astext())}</{tag}>')
        raise nodes.SkipNode

    return write


def setup(app):
    app.add_html_math_renderer("katex", (formula("span"), None), (formula("div"), None))
