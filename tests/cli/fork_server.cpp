// SPDX-License-Identifier: Apache-2.0
// Preloaded into the program (LD_PRELOAD), it waits before main() for command lines, and runs main() in a fork for
// each: the very program, without the time that loading its libraries takes. harness.py asks, over the socket that
// GAZETRACE_FORK_SERVER_SOCKET names:
//   a request: the length of what follows (4 bytes), with the descriptors of stdout and stderr beside it; then texts
//   that end with 0: the working folder, the number of arguments, the arguments, the environment the answer: the number
//   of the process at its start, and its state as waitpid() tells it at its end (4 bytes each)
#include <dlfcn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

using Main = int (*)(int, char**, char**);
using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);

Main program = nullptr;

struct Request {
  std::vector<char> texts;
  std::array<int, 2> outputs{-1, -1};
};

bool read_all(int socket, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::read(socket, to, size);
    if (got <= 0) {
      return false;
    }
    to += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

// False: who asks has gone.
bool receive(int socket, Request& request) {
  std::uint32_t size = 0;
  iovec place{&size, sizeof size};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof request.outputs)> beside{};
  msghdr message{};
  message.msg_iov = &place;
  message.msg_iovlen = 1;
  message.msg_control = beside.data();
  message.msg_controllen = beside.size();
  const cmsghdr* head = nullptr;
  if (::recvmsg(socket, &message, MSG_CMSG_CLOEXEC) != sizeof size || (head = CMSG_FIRSTHDR(&message)) == nullptr) {
    return false;
  }
  std::memcpy(request.outputs.data(), CMSG_DATA(head), sizeof request.outputs);
  request.texts.resize(size);
  return read_all(socket, request.texts.data(), size);
}

[[noreturn]] void run(Request& request, int socket) {
  ::close(socket);
  ::dup2(request.outputs[0], STDOUT_FILENO);
  ::dup2(request.outputs[1], STDERR_FILENO);
  std::vector<char*> texts;
  for (char* text = request.texts.data(); text < request.texts.data() + request.texts.size();
       text += std::strlen(text) + 1) {
    texts.push_back(text);
  }
  const int count = std::atoi(texts[1]);
  std::vector<char*> arguments(texts.begin() + 2, texts.begin() + 2 + count);
  std::vector<char*> variables(texts.begin() + 2 + count, texts.end());
  arguments.push_back(nullptr);
  variables.push_back(nullptr);
  environ = variables.data();
  if (::chdir(texts[0]) != 0) {
    ::_exit(127);
  }
  const int code = program(count, arguments.data(), environ);
  // Not exit(): libraries that started threads as they were loaded would wait for those, which are not in a fork.
  std::fflush(nullptr);
  ::_exit(code);
}

int serve(int argc, char** argv, char** variables) {
  const char* name = std::getenv("GAZETRACE_FORK_SERVER_SOCKET");
  if (name == nullptr) {
    return program(argc, argv, variables);
  }
  const int socket = std::atoi(name);
  if (const char* const library = std::getenv("GAZETRACE_FORK_SERVER_LOADS")) {
    ::dlopen(library, RTLD_LAZY | RTLD_LOCAL);  // what runs would load one by one; they tell where it is missing
  }
  for (Request request; receive(socket, request);) {
    const pid_t child = ::fork();
    if (child == 0) {
      run(request, socket);
    }
    ::close(request.outputs[0]);
    ::close(request.outputs[1]);
    int state = -1;
    if (child < 0 || ::write(socket, &child, sizeof child) != sizeof child || ::waitpid(child, &state, 0) != child ||
        ::write(socket, &state, sizeof state) != sizeof state) {
      return 1;
    }
  }
  return 0;
}

}  // namespace

// The C library's own entry, which is found here first.
extern "C" int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld_fini)(),
                                 void* stack_end) {
  program = main;
  const auto start = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(serve, argc, argv, init, fini, rtld_fini, stack_end);
}
