#include <fmt/format.h>
#include <cmath>
#include "libperception/calibration/ClusterSamples.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/pipeline/LogRecorder.h"
using namespace perception;
int main(int argc,char**argv){
  const auto c=ClusterClassifier::read(argv[1]);
  fmt::print("prior"); for(double p:c.prior()) fmt::print(" {:.4f}",p); fmt::print("\n");
  for(int a=3;a<argc;++a){
    const std::string log=argv[a];
    PipelineSetup setup=PipelineSetup::fromFile(argv[2],{"run.sensors=L"});
    auto s=std::find_if(setup.sensors.begin(),setup.sensors.end(),[](auto&x){return x.active&&dynamic_cast<const LidarFrontEnd*>(x.front_end.get());});
    ClusterSamples samples; PointLabels labels(log); GroundTruth truth; SampleRules rules;
    ClusterSampler sampler(s->label,dynamic_cast<const LidarFrontEnd&>(*s->front_end),truth,labels,0,rules,samples);
    passLog(log,forFrontEnds(setup),0,sampler);
    // share of phantom raw, EM
    std::array<std::array<int,4>,7> n{}; std::array<std::array<double,7>,7> sum{}; std::array<int,7> tot{};
    const auto prior=c.prior();
    double pi=prior[4]; std::vector<std::array<double,kClusterKinds>> ps;
    for(auto&x:samples.clusters){ if(x.whole>=0) continue; ps.push_back(c.probabilities(x.descriptor));}
    for(int it=0;it<50;++it){ double acc=0; const double r=pi/prior[4]*(1-prior[4])/(1-pi); for(auto&p:ps){acc+=p[4]*r/(p[4]*r+1-p[4]);} pi=acc/double(ps.size()); }
    fmt::print("{} wholes {} EM share {:.4f}\n",log,ps.size(),pi);
    const double r=pi/prior[4]*(1-prior[4])/(1-pi);
    std::size_t k=0;
    for(auto&x:samples.clusters){ if(x.whole>=0) continue; auto p=ps[k++]; std::size_t t=x.kind?std::size_t(*x.kind):6; ++tot[t];
      const double near=std::hypot(x.place.x(),x.place.y()); (void)near;
      for(int j=0;j<6;++j) sum[t][std::size_t(j)]+=p[std::size_t(j)];
      const double q=p[4]*r/(p[4]*r+1-p[4]); sum[t][6]+=q; n[t][0]+=p[4]>.7; n[t][1]+=q>.7; n[t][2]+=*std::max_element(p.begin(),p.begin()+3)>.3; n[t][3]+=*std::max_element(p.begin(),p.begin()+3)*(1-q)/(1-p[4]+1e-9)>.3; }
    const char*names[]={"ped","cyc","veh","thing","phantom","mixed","unknown"};
    for(std::size_t t=0;t<7;++t) if(tot[t]){ fmt::print("  true {} {}: mean",names[t],tot[t]); for(double v:sum[t]) fmt::print(" {:.3f}",v/tot[t]); fmt::print(" | ph>.7 {} adj {} user>.3 {} adj {}\n",n[t][0],n[t][1],n[t][2],n[t][3]); }
  }
}
