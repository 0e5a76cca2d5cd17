"""What scripts that write a variant of a scene share: it is read, its text changed, the new one written whole."""

import sys
import tomllib

from jointcreep import files


class NotWanted(Exception):
    """The scene cannot be changed as asked."""


def write_variant(parser, change):
    """Writes change(text, arguments) of the scene's text, by the command line of `parser`, which gets scene and -o here.
    Ends with exit code 2 and a message if the scene cannot be read, changed or written."""
    parser.add_argument("scene", metavar="SCENE.toml")
    parser.add_argument("-o", "--output", metavar="NAME.toml", required=True)
    arguments = parser.parse_args()
    try:
        with open(arguments.scene, encoding="utf-8-sig") as file:
            text = change(file.read(), arguments)
        tomllib.loads(text)
        files.write_text(arguments.output, text)
    except (OSError, NotWanted, tomllib.TOMLDecodeError) as error:
        print(f"{parser.prog}: {arguments.scene}: {error}", file=sys.stderr)
        sys.exit(2)
