"""fpbm-cpp completion."""

import click
from click.shell_completion import get_completion_class


@click.command(
    "completion",
    short_help="Make a shell complete these commands.",
    epilog="""\b
Examples:
  eval "$(fpbm-cpp completion bash)"      # in ~/.bashrc
  eval "$(fpbm-cpp completion zsh)"       # in ~/.zshrc
  fpbm-cpp completion fish > ~/.config/fish/completions/fpbm-cpp.fish""",
)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print what makes a shell complete fpbm-cpp's commands and options."""
    kind = get_completion_class(shell)
    assert kind is not None
    click.echo(kind(context.find_root().command, {}, "fpbm-cpp", "_FPBM_CPP_COMPLETE").source())
