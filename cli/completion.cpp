// soapfilm completion SHELL: hidden, for packages and for a user's own shell.
#include "cli/completion.h"

#include <memory>

#include "cli/command.h"
#include "cli/parse.h"
#include "cli/print.h"

namespace soapfilm::cli {

void add_completion(CLI::App& app, Runner& runner) {
  CLI::App* command = app.add_subcommand("completion", "Print a script that completes soapfilm's command line");
  command->group("");  // hidden
  command->footer(
      "EXAMPLES\n"
      "  source <(soapfilm completion bash)\n"
      "  soapfilm completion fish > ~/.config/fish/completions/soapfilm.fish\n");
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(one_of({"bash", "zsh", "fish"}))
      ->option_text("SHELL");
  command->callback([&app, shell, &runner] {
    runner = [&app, shell] {
      const CompletionSource source{command_table(app), command_tables(app)};
      print(stdout, *shell == "bash"  ? bash_completion(source)
                    : *shell == "zsh" ? zsh_completion(source)
                                      : fish_completion(source));
      return 0;
    };
  });
}

}  // namespace soapfilm::cli
