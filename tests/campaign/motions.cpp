#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>
#include "splinecast/ipc/sampler.hpp"
#include "splinecast/core/limits.hpp"
#include "support/memory_stream.hpp"
using namespace splinecast;
using core::Time;
constexpr std::size_t D = 6;
struct M { double a1[D], w1[D], p1[D], a2[D], w2[D], p2[D];
  M(unsigned seed) { std::mt19937 r(seed); std::uniform_real_distribution<> u(0,1);
    for (std::size_t d=0; d<D; ++d) { w1[d]=0.6+0.5*u(r); w2[d]=1.3+0.6*u(r); p1[d]=6.28*u(r); p2[d]=6.28*u(r); a1[d]=0.8/ w1[d]/ (1); a2[d]=0.35/w2[d]; } }
  double x(std::size_t d, double t) const { return a1[d]*std::sin(w1[d]*t+p1[d])+a2[d]*std::sin(w2[d]*t+p2[d]); }
};
int main(int argc, char** argv) {
  double pv=0, pa=0; { M m(1); for (int i=0;i<20000;++i) for (std::size_t d=0; d<D; ++d) { double t=i*1e-3, h=1e-4; double v=(m.x(d,t+h)-m.x(d,t-h))/(2*h), a=(m.x(d,t+h)-2*m.x(d,t)+m.x(d,t-h))/(h*h); pv=std::max(pv,std::abs(v)); pa=std::max(pa,std::abs(a)); } }
  std::printf("motion: v %.2f a %.2f\n", pv, pa);
  struct Row { const char* name; double hz, lead, late; bool silences; };
  const Row rows[] = {{"30 Hz 60 ms late 0-90", 30, .06, .09, false}, {"100 Hz 200 ms", 100, .2, 0, false}, {"100 Hz 200 ms silences", 100, .2, 0, true}, {"100 Hz 60 ms silences", 100, .06, 0, true}};
  for (double noise : {0.0, 1e-4}) for (const Row& row : rows) for (double limit : {5.0, 10.0, 20.0, 0.0}) {
    M m(1); std::mt19937 r(7); std::uniform_real_distribution<> u(0,1); std::normal_distribution<> g(0, noise);
    core::WindowOptions how; how.held_before_start = true; how.start.kind = core::ConditionKind::halt; how.limits.acceleration = limit>0 ? std::vector<double>(D, limit) : std::vector<double>(); how.stop_time = Time(250000000);
    testing::MemoryStream s(D, how, 4096, 4096, {}, {}, ipc::LiveOptions{});
    ipc::Sampler sampler(s.board.reader, ipc::StreamClock::monotonic, {});
    core::State st(D);
    const Time begin(1'000'000'000'000);
    const int n = int(20*row.hz);
    struct W { double at; double t; }; std::vector<W> ws;
    double last=-10; for (int i=0;i<n;++i) { double t=i/row.hz; double at=t-row.lead+row.late*u(r); if (row.silences) { double k=std::fmod(at+10,2.0); if (k<0.3 && at>0.5) at += 0.3-k; } at=std::max(at,last); last=at; ws.push_back({at,t}); }
    std::size_t next=0; std::vector<double> err; double amax=0, vmax=0; long hold=0, total=0, past=0, refused=0; double maxbeyond=0;
    for (int ms=-300; ms<20000; ++ms) {
      s.clock.time = begin + Time(std::int64_t(ms)*1'000'000);
      double now=ms*1e-3;
      while (next<ws.size() && ws[next].at<=now) { std::vector<double> x(D); for (std::size_t d=0; d<D; ++d) x[d]=m.x(d, ws[next].t) + (noise>0?g(r):0); auto status=s.append(begin+Time(std::int64_t(std::llround(ws[next].t*1e9))), x); if (status!=ipc::AppendStatus::accepted) ++refused; ++next; }
      for (int k=0;k<8;++k) { auto res=s.solver.step(s.clock); if (res.consumed==0 && s.solver.due()>s.clock.time) break; }
      auto status=sampler.sample(s.clock.time, st);
      if (ms<0 || !ipc::has_values(status)) continue;
      ++total; if (status==ipc::SampleStatus::holding) ++hold;
      double e=0; for (std::size_t d=0; d<D; ++d) { e=std::max(e,std::abs(st.position()[d]-m.x(d,now))); amax=std::max(amax,std::abs(st.acceleration()[d])); vmax=std::max(vmax,std::abs(st.velocity()[d])); }
      if (ms>2000) err.push_back(e);
    }
    std::sort(err.begin(),err.end());
    const auto& h=s.solver.head();
    std::printf("%-24s noise %g limit %4g: a %8.2f v %5.2f err %.4f %.4f %.4f hold %.2f%% passed %llu refused %llu under %llu\n", row.name, noise, limit, amax, vmax, err[err.size()/2], err[err.size()*99/100], err.back(), 100.0*hold/total, (unsigned long long)h.passed_over, (unsigned long long)h.refused, (unsigned long long)h.underruns);
    (void)past; (void)maxbeyond; (void)refused;
  }
}
