#include "app/review/routes.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "app/documents/replay.h"
#include "app/exchange/trial_list.h"
#include "app/report/report.h"
#include "app/review/answers.h"
#include "app/review/changes.h"
#include "app/review/corrections.h"
#include "app/review/logging.h"
#include "app/review/page_files.h"
#include "app/review/recording_routes.h"
#include "app/review/relinking.h"
#include "app/review/thumbnail.h"
#include "app/review/trajectory.h"
#include "app/review/trial_view.h"
#include "app/text/json.h"
#include "app/text/text_file.h"
#include "app/trials/statement.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/identity.h"

namespace touchdown::review {
namespace {

using report::Json;

// Returns the type by which the browser reads a file. What is not known is
// text: it is shown and never run (nosniff).
std::string ContentType(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".json")) return "application/json";
  return "text/plain; charset=utf-8";
}

// Returns a file of the page, out of the program itself (embed.cmake).
Reply PageReply(const std::string& name) {
  const auto file = PageFile(name);
  if (!file) throw NotThere("/page/" + name);
  Reply reply;
  reply.type = ContentType(name);
  reply.body = *file;
  return reply;
}

// The part of `path` after `prefix`; nothing where it begins otherwise.
std::optional<std::string> StripPrefix(const std::string& path,
                                       std::string_view prefix) {
  if (!path.starts_with(prefix)) return std::nullopt;
  return path.substr(prefix.size());
}

// Returns the plot of a group. Groups are counted from 0, as in
// /api/statistics.
Reply PlotReply(Desk& desk, const Request& request, const std::string& text) {
  const auto n = static_cast<std::size_t>(ParsePathNumber(text, request.path));
  const auto statistics = desk.StatisticsNow();
  if (n >= statistics->plots.size()) throw NotThere(request.path);
  Reply reply;
  reply.type = "image/svg+xml";
  reply.body = statistics->plots[n];
  return reply;
}

// --- one trial ---------------------------------------------------------------

// Returns the revision that ?revision=N asks for, without it the one in force,
// which is not the last where a proposal waits.
core::Trial FindRevision(const std::vector<db::Revision>& history,
                         const Request& request) {
  const auto asked = request.query.find("revision");
  if (asked == request.query.end()) {
    return db::RevisionInForce(history).trial;
  }
  const std::int64_t n = ParsePathNumber(asked->second, request.path);
  for (const auto& revision : history) {
    if (revision.trial.revision == n) return revision.trial;
  }
  throw NotThere(request.path + "?revision=" + asked->second);
}

// Tells size and frames of a trial's recording, or why there are no pictures: a
// recording that is gone must not hide the numbers.
Json ClipOfTrialJson(Desk& desk, const core::Trial& trial) {
  if (trial.clip.path.empty()) return {{"absent", "logged by hand"}};
  try {
    return ClipJson(desk.shelf().Info({trial.clip.path}));
  } catch (const core::InputError& error) {
    return {{"absent", error.what()}};
  }
}

// Answers GET /api/trials/ID: all that the page shows of a trial in one answer,
// from one reading of its history.
Reply TrialReply(Desk& desk, const Request& request, const std::string& id) {
  const db::Store store = desk.Open(db::OpenMode::kRead);
  const auto history = store.History(id);
  if (history.empty()) throw NotThere(request.path);
  const core::Trial trial = FindRevision(history, request);
  const db::Revision* proposal = db::OpenProposal(history);
  Json json = {{"schema", "touchdown.review.trial/1"},
               {"store_id", store.uuid()},
               {"row", report::TrialRowJson(trial)},
               {"last_revision", db::RevisionInForce(history).trial.revision},
               {"proposal", proposal != nullptr ? Json(proposal->trial.revision)
                                                : Json(nullptr)},
               {"simulated", trial.origin == core::Origin::kSimulated},
               {"numbers", NumbersJson(trial)},
               {"history", HistoryJson(history)},
               {"clip", ClipOfTrialJson(desk, trial)}};
  // The stored track is judged again, which takes milliseconds; no pixel is
  // read.
  const auto analysis = pipeline::Replay(trial);
  json["view"] = analysis ? ViewJson(*analysis)
                          : Json{{"absent", analysis.error().reason}};
  return JsonReply(json);
}

// Returns frame `number`, counted from 0 in the file, as a picture.
Reply FrameReply(Desk& desk, const Request& request, const std::string& id,
                 const std::string& number) {
  const std::int64_t n = ParsePathNumber(number, request.path);
  const std::string clip = desk.FindClipPath(id);
  if (clip.empty()) throw NotThere(request.path);
  return PictureReply(desk.shelf().Frame({clip, AskedSteady(request)}, n));
}

// The trial as it stands, or the revision asked for.
core::Trial AskedTrial(Desk& desk, const Request& request,
                       const std::string& id) {
  const auto history = desk.Open(db::OpenMode::kRead).History(id);
  if (history.empty()) throw NotThere(request.path);
  return FindRevision(history, request);
}

// Returns the small picture of the trial in force.
Reply ThumbnailReply(Desk& desk, const Request& request,
                     const std::string& id) {
  const auto trial = desk.Open(db::OpenMode::kRead).Find(id);
  if (!trial || trial->clip.path.empty()) throw NotThere(request.path);
  return PictureReply(RenderThumbnail(desk.shelf(), *trial));
}

// Returns the path as a file to save. Its name bears the trial's short id, so
// that several in one folder are told apart.
Reply TrajectoryReply(Desk& desk, const Request& request,
                      const std::string& id) {
  const auto csv = TrajectoryCsv(AskedTrial(desk, request, id));
  if (!csv) return Refusal(404, csv.error().reason);
  Reply reply;
  reply.type = "text/csv; charset=utf-8";
  reply.body = *csv;
  reply.headers = {
      {"Content-Disposition", fmt::format("attachment; filename=trajectory-"
                                          "{}.csv",
                                          db::ShortId(id))}};
  return reply;
}

// Returns the trial in force. Throws NotThere.
core::Trial RequireTrial(const db::Store& store, const std::string& id,
                         const Request& request) {
  auto trial = store.Find(id);
  if (!trial) throw NotThere(request.path);
  return *std::move(trial);
}

// /api/trials/ID/...
struct TrialPath {
  std::string id;
  std::string rest;  // after the next slash; empty: none
};

// Divides /api/trials/ID/REST; returns nothing for another path.
std::optional<TrialPath> ParseTrialPath(const std::string& path) {
  const auto rest = StripPrefix(path, "/api/trials/");
  if (!rest) return std::nullopt;
  const std::size_t slash = rest->find('/');
  if (slash == std::string::npos) return TrialPath{*rest, ""};
  return TrialPath{rest->substr(0, slash), rest->substr(slash + 1)};
}

// --- report ------------------------------------------------------------------

// Returns a file of the report that was built last. `sandbox` keeps whatever a
// report holds from asking this server in the page's name.
Reply ReportFile(Desk& desk, const Request& request, const std::string& name) {
  // The files that a report is, and no other of the folder.
  if (std::find(std::begin(report::kReportFiles),
                std::end(report::kReportFiles),
                name) == std::end(report::kReportFiles)) {
    throw NotThere(request.path);
  }
  const std::filesystem::path path = desk.reports() / name;
  if (!std::filesystem::exists(path)) throw NotThere(request.path);
  Reply reply;
  reply.type = ContentType(name);
  reply.body = report::ReadTextFile(path);
  // As the report says of itself: styles stand in it, nothing is loaded.
  reply.headers = {{"Content-Security-Policy",
                    "default-src 'none'; style-src 'unsafe-inline'; img-src "
                    "data:; frame-ancestors 'self'; sandbox"}};
  if (!name.ends_with(".html")) {
    reply.headers.emplace_back("Content-Disposition",
                               fmt::format("attachment; filename={}", name));
  }
  return reply;
}

// Answers what changes nothing. Throws NotThere for a path that is none.
Reply Get(Desk& desk, const Request& request) {
  const std::string& path = request.path;
  if (auto reply = GetOfRecordings(desk, request)) return *std::move(reply);
  if (path == "/") return PageReply("index.html");
  if (const auto name = StripPrefix(path, "/page/")) return PageReply(*name);
  if (path == "/api/stamp") {
    return JsonReply(
        {{"stamp", desk.Stamp()},
         {"store", std::filesystem::absolute(desk.store()).string()}});
  }
  if (path == "/api/trials") {
    // The stamp is taken before the list is read: what is written in between
    // makes the page ask once more.
    const std::string stamp = desk.Stamp();
    Json json = desk.HasStore() ? TrialListJson(desk.Open(db::OpenMode::kRead),
                                                desk.triage())
                                : EmptyListJson(desk.store());
    json["stamp"] = stamp;
    return JsonReply(json);
  }
  if (path == "/api/statistics") {
    Reply reply;
    reply.body = desk.StatisticsNow()->json;
    return reply;
  }
  if (const auto n = StripPrefix(path, "/api/plots/")) {
    return PlotReply(desk, request, *n);
  }
  if (const auto trial = ParseTrialPath(path)) {
    if (trial->rest.empty()) return TrialReply(desk, request, trial->id);
    if (trial->rest == "thumbnail") {
      return ThumbnailReply(desk, request, trial->id);
    }
    if (trial->rest == "trajectory.csv") {
      return TrajectoryReply(desk, request, trial->id);
    }
    if (const auto n = StripPrefix(trial->rest, "frames/")) {
      return FrameReply(desk, request, trial->id, *n);
    }
  }
  if (const auto name = StripPrefix(path, "/report/")) {
    return ReportFile(desk, request, *name);
  }
  throw NotThere(path);
}

Json LoggedJson(const db::Logged& logged) {
  return {{"id", logged.id},
          {"revision", logged.revision},
          {"is_new", logged.is_new}};
}

// Answers what changes or computes something. A store is opened for writing
// only where something is stored: a preview needs no right to write.
Reply Post(Desk& desk, const Request& request) {
  // A body that is no JSON throws, and is answered by 400 (Route).
  const auto asked = nlohmann::json::parse(request.body);
  const std::string& path = request.path;
  if (auto reply = PostToRecordings(desk, path, asked)) {
    return *std::move(reply);
  }
  if (const auto trial = ParseTrialPath(path)) {
    if (trial->rest == "preview") {
      const db::Store store = desk.Open(db::OpenMode::kRead);
      return JsonReply(
          PreviewJson(RequireTrial(store, trial->id, request), asked));
    }
    if (trial->rest == "revisions") {
      db::Store store = desk.Open(db::OpenMode::kWrite);
      // An id that is not there is a wrong path (404) and no trouble of the
      // store (503).
      RequireTrial(store, trial->id, request);
      return JsonReply(LoggedJson(Revise(store, trial->id, asked)));
    }
  }
  if (path == "/api/log") {
    return JsonReply(LoggedJson(LogTyped(desk.store(), asked)));
  }
  if (path == "/api/relink") {
    return JsonReply(RelinkedJson(desk.store(), asked));
  }
  if (path == "/api/report") {
    return JsonReply(
        {{"trials", BuildReport(desk.store(), desk.reports(), desk.reach_of())},
         {"folder", desk.reports().string()}});
  }
  throw NotThere(path);
}

}  // namespace

// The order of the handlers is from the narrower type to the wider: FieldError
// is an invalid_argument, OutputError an InputError.
Reply Route(Desk& desk, const Request& request) {
  try {
    // HEAD is answered as GET is; the body is left out when it is written.
    const bool reads = request.method == "GET" || request.method == "HEAD";
    return reads ? Get(desk, request) : Post(desk, request);
  } catch (const NotThere& error) {
    return Refusal(404, error.what());
  } catch (const Conflict& error) {
    return Refusal(409, error.what());
  } catch (const pipeline::FieldError& error) {
    // The page puts `problem` beside the input that `field` names.
    Reply reply = Refusal(400, error.what());
    reply.body =
        nlohmann::json{{"error", error.what()},
                       {"field", error.field()},
                       {"problem", error.problem()}}
            .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    return reply;
  } catch (const nlohmann::json::exception& error) {
    return Refusal(
        400, fmt::format("the request is not understood: {}", error.what()));
  } catch (const std::invalid_argument& error) {
    return Refusal(400, error.what());
  } catch (const core::OutputError& error) {
    return Refusal(507, error.what());
  } catch (const core::InputError& error) {
    return Refusal(422, error.what());
  } catch (const core::StoreError& error) {
    return Refusal(503, error.what());
  } catch (const std::exception& error) {
    return Refusal(500, error.what());
  }
}

}  // namespace touchdown::review
