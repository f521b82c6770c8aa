"""The command fpbm-cpp, also python -m fpbm_cpp."""

import sys


def main() -> int:
    """Run the command line. If a library is missing, print the pip command that installs it."""
    try:
        from .cli import command
    except ModuleNotFoundError as missing:
        print(f'fpbm-cpp needs {missing.name}: pip install "fpbm_cpp[cli]"', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    command(prog_name="fpbm-cpp")
    return 0


if __name__ == "__main__":
    sys.exit(main())
