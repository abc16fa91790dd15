#include "apps/cli/guarded.hpp"

#include <exception>
#include <stdexcept>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps {

int run_guarded(const std::function<int()>& action) {
  try {
    return action();
  } catch (const InputError& error) {
    say(error.what());
    return kBadUsageOrInput;
  } catch (const std::invalid_argument& error) {
    say(error.what());
    return kBadUsageOrInput;
  } catch (const BadRequest& error) {
    say(error.what());
    return kBadUsageOrInput;
  } catch (const ClosedPipe&) {
    return kFailed;
  } catch (const Interrupted& error) {
    say(error.what());
    return kInterrupted;
  } catch (const TimeOut& error) {
    say(error.what());
    return kNoStreamOrTimeOut;
  } catch (const NoSuchStream& error) {
    say(error.what());
    return kNoStreamOrTimeOut;
  } catch (const std::exception& error) {
    say(error.what());
    return kFailed;
  }
}

}  // namespace splinecast::apps
