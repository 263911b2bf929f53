#pragma once
#include <limits>
#include <memory>
#include <optional>

#include "server/radar/beam/echo_rows.h"
#include "server/radar/beam/echo_sums.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"

namespace obliq {

/// Makes the wedges that a display gets of those of what is looked at: by the sums over beam and pulse, or as
/// they are. From any thread.
class WedgeSums {
 public:
  virtual ~WedgeSums() = default;

  /// Wedges to look at, in the order in which they are needed.
  virtual int n_wedges() const = 0;
  virtual int wedge(int k) const = 0;
  virtual bool needs_iq() const = 0;

  /// What is needed of one.
  struct Needed {
    double far_m = std::numeric_limits<double>::infinity();  ///< nothing beyond
    bool states = true;
    bool returns = false;  ///< of labels, whose other planes are all or none
    HitObserver* observer = nullptr;
  };
  virtual Needed needed(int wedge) const = 0;
  /// Takes one that an earlier rendering has left. False: it is to be looked at.
  virtual bool take_kept(int wedge) = 0;
  virtual void take(Wedge&& wedge) = 0;

  /// A wedge for the display of which nothing is missing, each once. False: none at the moment.
  /// buffers: the calling thread's, made when they are first needed.
  virtual bool next(std::unique_ptr<EchoSums>& buffers, Wedge& wedge) = 0;
};

/// For the display's wedges [first, end). plan and options must outlive it.
std::unique_ptr<WedgeSums> make_wedge_sums(const FramePlan& plan, int first, int end,
                                           const RenderOptions& options);

/// Looks at all wedges of some sums, on several threads. False when stopped. (wedge_threads.cpp)
bool look_at_wedges(const FramePlan& plan, WedgeSums& sums, const RenderOptions& options);

/// Rows of sharp bins behind a beam, with the I&Q and the materials that sums over them need: azimuth 0 of a
/// window of one. azimuths: of the plan, that they count for. Nothing when stopped.
std::optional<EchoRows::Ready> look_at_rows(const FramePlan& plan, const RowWindow& window,
                                            AzimuthRange azimuths, const RenderOptions& options);

}  // namespace obliq
