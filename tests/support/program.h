// Running the program under test, as a user does.
#pragma once

#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace onepass {

struct Outcome {
    int exit_code = -1;
    std::string out;
    std::string err;
};

/// Starts the program in `folder` with stdout and stderr in files there.
inline pid_t start(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {ONEPASS_BINARY};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = folder.path() / ".stdout";
    const std::string err = folder.path() / ".stderr";
    const std::string where = folder.path();

    const pid_t child = fork();
    if (child != 0) return child;
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    dup2(open(out.c_str(), flags, 0644), STDOUT_FILENO);
    dup2(open(err.c_str(), flags, 0644), STDERR_FILENO);
    if (chdir(where.c_str()) == 0) execv(argv[0], argv.data());
    _exit(127);
}

inline Outcome finish(const TemporaryFolder& folder, pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
            read_bytes(folder.path() / ".stdout"), read_bytes(folder.path() / ".stderr")};
}

inline Outcome onepass_in(const TemporaryFolder& folder,
                          const std::vector<std::string>& arguments) {
    return finish(folder, start(folder, arguments));
}

}  // namespace onepass
