#include "app/review/http_server.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "app/review/guard.h"
#include "app/review/http_connection.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

// Numbers of epoll's data; connections have those above.
constexpr std::uint64_t kListener = 0;
constexpr std::uint64_t kWake = 1;
constexpr std::uint64_t kFirstConnection = 2;
constexpr std::size_t kMostEvents = 64;
// How often deadlines are looked at, ms.
constexpr int kLookEvery_ms = 500;
// How long what a refused client still sends is thrown away, so that it reads
// its answer before the connection is reset.
constexpr std::chrono::milliseconds kDrainTime{2000};

// Returns how many connections may be held: half of the process's open files at
// most, since recordings and the store need the rest.
std::size_t MostConnections(std::size_t asked) {
  rlimit files = {};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return asked;
  return std::max<std::size_t>(1, std::min<rlim_t>(asked, files.rlim_cur / 2));
}

}  // namespace

// The server's state, by who may touch it: connections belong to the thread in
// Loop(); tasks and finished answers cross over to the threads in Work() and
// back, under `mutex`. A connection is known across threads by its number and
// never by its address: it may have gone before its answer is ready.
struct HttpServer::Impl {
  using Stage = Connection::Stage;
  struct Task {
    std::uint64_t connection = 0;
    Request request;
    ReplyForm form;
  };
  struct Finished {
    std::uint64_t connection = 0;
    std::string bytes;
  };

  ~Impl() {
    for (const int descriptor : {listener, wake, events}) {
      if (descriptor >= 0) close(descriptor);
    }
  }

  // --- threads that answer ---------------------------------------------------

  // The loop of a thread that answers. It ends at Stop() without looking at the
  // tasks that still wait.
  void Work() {
    for (;;) {
      Task task;
      {
        std::unique_lock lock(mutex);
        ready.wait(lock, [this] { return stops || !tasks.empty(); });
        if (stops) return;
        task = std::move(tasks.front());
        tasks.pop_front();
      }
      std::string bytes = WriteReply(answers.answer(task.request), task.form);
      {
        const std::lock_guard lock(mutex);
        finished.push_back({task.connection, std::move(bytes)});
      }
      Wake();
    }
  }

  // Ends the wait in Loop(), which looks at finished answers and at `stops`
  // then.
  void Wake() const {
    const std::uint64_t one = 1;
    // It can only fail where it is awake already.
    [[maybe_unused]] const ssize_t n = write(wake, &one, sizeof one);
  }

  // --- the thread that has the connections -----------------------------------

  // Tells epoll what to report of a connection; `what` = 0: only that it broke.
  void Watch(const Connection& c, std::uint32_t what, int how) const {
    epoll_event event = {};
    event.events = what;
    event.data.u64 = c.number;
    epoll_ctl(events, how, c.socket, &event);
  }

  // Takes all connections that wait.
  void Accept() {
    for (;;) {
      const int socket =
          accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (socket < 0) {
        // No descriptor is left: without room the loop would be woken for ever
        // by a connection that it cannot take.
        if ((errno == EMFILE || errno == ENFILE) && DropSlowest()) continue;
        return;
      }
      const int yes = 1;
      // Answers go out at once: the page steps through frames one request at a
      // time.
      setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      auto connection = std::make_unique<Connection>(socket, next_number++);
      connection->deadline = HttpClock::now() + options.head_time;
      // Where everybody is owed an answer the new one is closed by its
      // destructor.
      if (connections.size() >= most_connections && !DropSlowest()) continue;
      Watch(*connection, EPOLLIN, EPOLL_CTL_ADD);
      connections.emplace(connection->number, std::move(connection));
    }
  }

  // The one that has waited longest among those that nothing is owed to;
  // strangers before those that have shown the key.
  bool DropSlowest() {
    auto slowest = connections.end();
    for (auto it = connections.begin(); it != connections.end(); ++it) {
      const Connection& c = *it->second;
      if (c.stage != Stage::kHead && c.stage != Stage::kDraining) continue;
      if (slowest == connections.end() ||
          std::pair(c.was_admitted, c.since) <
              std::pair(slowest->second->was_admitted,
                        slowest->second->since)) {
        slowest = it;
      }
    }
    if (slowest == connections.end()) return false;
    connections.erase(slowest);
    return true;
  }

  // Forgets a connection and gives back the room of its body. `c` is gone then.
  void Drop(const Connection& c) {
    if (c.stage == Stage::kBody || c.stage == Stage::kAnswering) {
      bodies_bytes -= c.head.body_bytes;
    }
    const std::uint64_t number = c.number;
    connections.erase(number);
  }

  // How much of it may be read at once.
  std::size_t ReadLimit(const Connection& c) const {
    if (c.stage == Stage::kHead) return options.most_head_bytes - c.in.size();
    if (c.stage == Stage::kBody) return c.head.body_bytes - c.in.size();
    return options.most_head_bytes;
  }

  // Acts on what epoll reports of one connection. `c` may be gone on return.
  void Handle(Connection& c, std::uint32_t what) {
    if ((what & (EPOLLERR | EPOLLHUP)) != 0) return Drop(c);
    if (c.stage == Stage::kWriting) return Write(c);
    if (c.stage == Stage::kAnswering) return;
    // The time for a head counts from its first byte: an idle connection that
    // sends again is not late.
    const bool begins = c.stage == Stage::kHead && c.in.empty();
    switch (ReadSome(c, ReadLimit(c))) {
      case Transfer::kLater:
        return;
      case Transfer::kClosed:
        return Drop(c);
      case Transfer::kDone:
        break;
    }
    if (c.stage == Stage::kDraining) {
      c.in.clear();
      return;
    }
    if (begins) c.deadline = HttpClock::now() + options.head_time;
    Advance(c);
  }

  // Goes on with what has been read.
  // A connection may hold the next request behind this one, so only the head is
  // taken away.
  void Advance(Connection& c) {
    if (c.stage == Stage::kHead) {
      const auto length = HeadLength(c.in);
      if (!length) {
        if (c.in.size() >= options.most_head_bytes) {
          c.head = {};
          Refuse(c, Refusal(431, "the request's head is too long"));
        }
        return;
      }
      // A head that is not understood is answered in the form of an empty one.
      auto head = ReadHead(std::string_view(c.in).substr(0, *length));
      c.in.erase(0, *length);
      if (!head) {
        c.head = {};
        return Refuse(c, std::move(head.error()));
      }
      c.head = *std::move(head);
      if (!Admit(c)) return;
    }
    if (c.stage == Stage::kBody && c.in.size() >= c.head.body_bytes) {
      DispatchRequest(c);
    }
  }

  // Whether its body is to be read.
  // Asks the guard first: who may not pass is told so whatever the body is.
  // Then the body's length is compared with what one request, and all together,
  // may send.
  bool Admit(Connection& c) {
    if (auto reply = answers.admit(c.head.request)) {
      Refuse(c, *std::move(reply));
      return false;
    }
    c.was_admitted = true;
    if (c.head.body_bytes > options.most_body_bytes) {
      Refuse(c, Refusal(413, fmt::format("a body of {} bytes; at most {} are "
                                         "taken",
                                         c.head.body_bytes,
                                         options.most_body_bytes)));
      return false;
    }
    if (bodies_bytes + c.head.body_bytes > options.most_bodies_bytes) {
      Refuse(c, Refusal(503, "too much is being sent at once; ask again"));
      return false;
    }
    bodies_bytes += c.head.body_bytes;
    c.stage = Stage::kBody;
    c.deadline = HttpClock::now() + options.body_time;
    if (c.head.awaits_continue && c.in.empty()) {
      constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
      // The first bytes on a connection that waits for them fit its buffer.
      [[maybe_unused]] const ssize_t n =
          send(c.socket, kContinue.data(), kContinue.size(),
               MSG_DONTWAIT | MSG_NOSIGNAL);
    }
    return true;
  }

  // Hands a whole request to the threads. The socket is not read meanwhile: a
  // client that sends on is held back by its own buffer.
  void DispatchRequest(Connection& c) {
    c.head.request.body = c.in.substr(0, c.head.body_bytes);
    c.in.erase(0, c.head.body_bytes);
    c.stage = Stage::kAnswering;
    c.closes = !c.head.keeps_alive;
    Watch(c, 0, EPOLL_CTL_MOD);
    Task task{c.number, std::move(c.head.request), MakeReplyForm(c)};
    {
      const std::lock_guard lock(mutex);
      tasks.push_back(std::move(task));
    }
    ready.notify_one();
  }

  // Returns how the answer is to be written.
  static ReplyForm MakeReplyForm(const Connection& c) {
    return {!c.closes, c.head.request.method != "HEAD"};
  }

  // An answer without a thread; the body that belongs to the request, and what
  // may come behind it, are not read.
  void Refuse(Connection& c, Reply reply) {
    c.closes =
        !c.head.keeps_alive || c.head.body_bytes > 0 || reply.status >= 400;
    Begin(c, WriteReply(reply, MakeReplyForm(c)));
  }

  // Begins to send an answer; mostly all of it goes out at once.
  void Begin(Connection& c, std::string bytes) {
    c.out = std::move(bytes);
    c.written = 0;
    c.stage = Stage::kWriting;
    c.deadline = HttpClock::now() + options.write_time;
    Write(c);
  }

  // Sends on. When all is sent the connection waits for its next request or,
  // where it closes, is drained.
  void Write(Connection& c) {
    const std::size_t before = c.written;
    switch (WriteSome(c)) {
      case Transfer::kClosed:
        return Drop(c);
      case Transfer::kLater:
        // A slow reader is not late as long as it takes something.
        if (c.written > before) {
          c.deadline = HttpClock::now() + options.write_time;
        }
        Watch(c, EPOLLOUT, EPOLL_CTL_MOD);
        return;
      case Transfer::kDone:
        break;
    }
    c.out = {};
    c.since = HttpClock::now();
    Watch(c, EPOLLIN, EPOLL_CTL_MOD);
    if (c.closes) {
      // Closing at once with unread bytes would reset the connection, and the
      // client might lose the answer that it is just reading.
      shutdown(c.socket, SHUT_WR);
      c.in = {};
      c.stage = Stage::kDraining;
      c.deadline = c.since + kDrainTime;
      return;
    }
    c.stage = Stage::kHead;
    c.deadline = c.since + options.idle_time;
    // The next request may have come together with the last one.
    if (!c.in.empty()) Advance(c);
  }

  // Sends what the threads have answered. The list is swapped out under the
  // lock, so that no thread waits while it is sent.
  void TakeFinished() {
    std::deque<Finished> all;
    {
      const std::lock_guard lock(mutex);
      all.swap(finished);
    }
    for (Finished& each : all) {
      const auto found = connections.find(each.connection);
      if (found == connections.end()) continue;  // it has gone
      bodies_bytes -= found->second->head.body_bytes;
      Begin(*found->second, std::move(each.bytes));
    }
  }

  // Closes connections whose time is up. One that waits for its answer has
  // none: the answer may take minutes. Late ones are collected first, since
  // Drop changes the map.
  void DropLate() {
    const auto now = HttpClock::now();
    std::vector<const Connection*> late;
    for (const auto& [number, c] : connections) {
      if (c->stage != Stage::kAnswering && now > c->deadline) {
        late.push_back(c.get());
      }
    }
    for (const Connection* c : late) Drop(*c);
  }

  // The loop of the thread that has the connections, until Stop().
  void Loop() {
    std::array<epoll_event, kMostEvents> happened;
    auto looked = HttpClock::now();
    while (!stops) {
      const int n =
          epoll_wait(events, happened.data(), static_cast<int>(happened.size()),
                     kLookEvery_ms);
      for (int i = 0; i < n; ++i) {
        const auto& event = happened[static_cast<std::size_t>(i)];
        if (event.data.u64 == kListener) {
          Accept();
        } else if (event.data.u64 == kWake) {
          std::uint64_t count = 0;
          [[maybe_unused]] const ssize_t got = read(wake, &count, sizeof count);
        } else if (const auto found = connections.find(event.data.u64);
                   found != connections.end()) {
          Handle(*found->second, event.events);
        }
      }
      TakeFinished();
      const auto now = HttpClock::now();
      if (now - looked >= std::chrono::milliseconds(kLookEvery_ms)) {
        DropLate();
        looked = now;
      }
    }
  }

  HttpOptions options;
  HttpAnswers answers;
  std::size_t most_connections = 1;
  int listener = -1;
  int wake = -1;
  int events = -1;
  int port = 0;
  // Of the thread that has the connections.
  std::map<std::uint64_t, std::unique_ptr<Connection>> connections;
  std::uint64_t next_number = kFirstConnection;
  std::size_t bodies_bytes = 0;  // of requests admitted and not yet answered
  // Of all threads.
  std::atomic<bool> stops = false;
  std::mutex mutex;
  std::condition_variable ready;
  std::deque<Task> tasks;
  std::deque<Finished> finished;
};

HttpServer::HttpServer(const HttpOptions& options, HttpAnswers answers)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->answers = std::move(answers);
  impl_->most_connections = MostConnections(options.most_connections);
  // What a person can cure (a port that is taken, too few descriptors) is found
  // here and not in Run().
  impl_->listener = ListenLocally(options.port);
  if (impl_->listener < 0) {
    throw core::InputError(
        fmt::format("port {} of 127.0.0.1 cannot be had; another program has "
                    "it: give another --port, or none",
                    options.port));
  }
  impl_->port = BoundPort(impl_->listener);
  impl_->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  impl_->events = epoll_create1(EPOLL_CLOEXEC);
  if (impl_->wake < 0 || impl_->events < 0) {
    throw core::InputError(
        "the server cannot wait for connections: no file "
        "descriptors are left; raise `ulimit -n`");
  }
  for (const auto& [descriptor, number] :
       {std::pair(impl_->listener, kListener), {impl_->wake, kWake}}) {
    epoll_event event = {};
    event.events = EPOLLIN;
    event.data.u64 = number;
    epoll_ctl(impl_->events, EPOLL_CTL_ADD, descriptor, &event);
  }
}

HttpServer::~HttpServer() { Stop(); }

int HttpServer::port() const { return impl_->port; }

// `threads` is declared before `ended` and so destroyed after it: Stop() comes
// before the threads are joined.
void HttpServer::Run() {
  std::vector<std::jthread> threads;
  // The threads are told to end before they are waited for, whatever happens.
  const std::unique_ptr<HttpServer, void (*)(HttpServer*)> ended(
      this, [](HttpServer* server) { server->Stop(); });
  for (std::size_t i = 0; i < impl_->options.threads; ++i) {
    threads.emplace_back([this] { impl_->Work(); });
  }
  impl_->Loop();
}

void HttpServer::Stop() {
  {
    // It is set under the lock: else a thread between its test and its wait
    // would miss it.
    const std::lock_guard lock(impl_->mutex);
    impl_->stops = true;
  }
  impl_->ready.notify_all();
  impl_->Wake();
}

}  // namespace touchdown::review
