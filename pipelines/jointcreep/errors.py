"""What ends a command with a message."""


class NotWanted(Exception):
    """A file or an option is not as expected: exit code 2."""


class NotDone(Exception):
    """Runs could not be made, though the study is right: exit code 4. The same command makes those that are missing."""
