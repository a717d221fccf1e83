// A seal is made from the store, written to a file and signed by a program of
// the user's. `db check --against` reads it again. The order in MakeSeal()
// matters: all that can be refused is refused before a file exists.
#include "app/cli/store/seal_command.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "app/cli/messages.h"
#include "app/cli/options.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/text/text_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/seal.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;

// Holds the flags as typed; without `out` only the head is printed.
struct SealFlags {
  std::string db;
  std::string out;
  std::string key;
};

// --- signing -----------------------------------------------------------------

// Describes a program that signs files: how it is called, which file it writes,
// and the command by which others verify that.
struct Signer {
  std::vector<std::string> command;
  std::string signature;  // the file that it writes
  std::string verify;
};

// Returns the signer for a private key; the text of the key's file tells whose
// it is. Throws core::InputError where the key cannot be read,
// std::invalid_argument where it is of none of the three programs.
Signer ChooseSigner(const std::string& key, const std::string& file) {
  const std::string text = report::ReadTextFile(key);
  if (text.starts_with("untrusted comment:")) {
    return {{"minisign", "-S", "-s", key, "-m", file, "-x", file + ".minisig"},
            file + ".minisig",
            fmt::format("minisign -V -p PUBLIC_KEY -m {}", file)};
  }
  if (text.starts_with("-----BEGIN OPENSSH PRIVATE KEY-----")) {
    return {{"ssh-keygen", "-Y", "sign", "-f", key, "-n", "touchdown", file},
            file + ".sig",
            fmt::format("ssh-keygen -Y verify -f ALLOWED_SIGNERS -I WHO -n "
                        "touchdown -s {0}.sig < {0}",
                        file)};
  }
  if (text.find("PRIVATE KEY-----") != std::string::npos) {
    return {{"openssl", "pkeyutl", "-sign", "-rawin", "-inkey", key, "-in",
             file, "-out", file + ".sig"},
            file + ".sig",
            fmt::format("openssl pkeyutl -verify -rawin -pubin -inkey "
                        "PUBLIC_KEY -in {0} -sigfile {0}.sig",
                        file)};
  }
  throw std::invalid_argument(fmt::format(
      "--key: {} is no private key of minisign, ssh-keygen or openssl (PEM)",
      key));
}

// Runs the signer and waits for it. It has the terminal, since it may ask for a
// passphrase; what it prints goes to stderr, because stdout is for the head
// alone. Throws core::OutputError where it cannot be started or does not sign.
void RunSigner(const std::vector<std::string>& command) {
  std::vector<char*> words;
  for (const std::string& word : command) {
    // posix_spawn does not change the words, though its type does not say so.
    words.push_back(const_cast<char*>(word.c_str()));
  }
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  pid_t child = 0;
  const int trouble =
      posix_spawnp(&child, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (trouble != 0) {
    throw core::OutputError(
        fmt::format("{}: cannot be started ({}); install it, or sign with "
                    "another kind of key",
                    command[0], std::strerror(trouble)));
  }
  int status = 0;
  // A signal may end the wait before the child is done.
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw core::OutputError(
        fmt::format("{}: could not sign; nothing was written", command[0]));
  }
}

// --- commands ----------------------------------------------------------------

// Seals what the store holds. Prints the head on stdout; with --out writes the
// whole seal and, with --key, its signature. Returns 0.
int MakeSeal(const SealFlags& flags) {
  if (!flags.key.empty() && flags.out.empty()) {
    throw std::invalid_argument("--key signs a file: give --out FILE, too");
  }
  std::optional<Signer> signer;
  if (!flags.key.empty()) signer = ChooseSigner(flags.key, flags.out);
  // Neither seal nor signature may replace one that is kept.
  for (const std::string& file :
       {flags.out, signer ? signer->signature : std::string()}) {
    if (!file.empty() && fs::exists(file)) {
      throw core::OutputError(fmt::format(
          "{}: this file exists, and seals are kept; give a new name", file));
    }
  }
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  const db::Seal seal = db::MakeSeal(store);
  if (!flags.out.empty()) {
    report::WriteTextFile(flags.out, db::SealText(seal));
    // Without the signature that was asked for the seal goes again: it would
    // look as if it had been left unsigned on purpose. So does what the signer
    // has written of the signature: it was not there before.
    try {
      if (signer) RunSigner(signer->command);
    } catch (...) {
      std::error_code ignored;
      fs::remove(flags.out, ignored);
      fs::remove(signer->signature, ignored);
      throw;
    }
  }
  fmt::print("{}\n", db::HeadText(seal.head));
  if (!flags.out.empty()) {
    fmt::print("{}: {} links, sealed {}\n", Printable(flags.out),
               seal.head.links, seal.sealed_at_utc);
  }
  if (signer) {
    fmt::print("{}: verify with `{}`\n", Printable(signer->signature),
               Printable(signer->verify));
  }
  return 0;
}

}  // namespace

void CheckSeal(const db::Store& store, const std::string& seal) {
  db::Seal sealed;
  // The text of a head, "UUID:LINKS:SHA256", is no name of a file in practice,
  // so it is tried first.
  if (const auto head = db::ParseHead(seal)) {
    sealed.head = *head;
  } else if (std::error_code ignored; fs::exists(seal, ignored)) {
    sealed = db::ParseSeal(report::ReadTextFile(seal), seal);
  } else {
    throw std::invalid_argument(fmt::format(
        "--against is '{}', must be a file of `touchdown db seal --out`, or "
        "the head that it printed",
        seal));
  }
  const db::SealCheck check = db::CheckStoreSeal(store, sealed);
  if (!check.problem.empty()) {
    throw core::StoreError(fmt::format(
        "{}: not what was sealed{}: {}", store.path().string(),
        sealed.sealed_at_utc.empty() ? "" : " at " + sealed.sealed_at_utc,
        Printable(check.problem)));
  }
  fmt::print("all {} links that were sealed{} are as they were, {} since\n",
             sealed.head.links,
             sealed.sealed_at_utc.empty() ? "" : " at " + sealed.sealed_at_utc,
             check.links_since);
}

void AddSeal(CLI::App& db, Action& action) {
  auto flags = std::make_shared<SealFlags>();
  CLI::App* seal = AddCommand(
      db, "seal",
      "print the head of the hash chain, to be kept apart from the store: `db "
      "check --against` finds what was altered since, whoever did it");
  AddDbFlag(*seal, flags->db);
  AddOption(*seal, "--out", flags->out,
            "write the whole seal, by which the first row that changed is "
            "named; a new file");
  AddOption(*seal, "--key", flags->key,
            "sign that file with this private key: of minisign, ssh-keygen or "
            "openssl (PEM)");
  SetAction(*seal, action, [flags] { return MakeSeal(*flags); });
}

}  // namespace touchdown::cli
