#!/usr/bin/python3
"""What a scan costs: millions of instructions by stage, and milliseconds where the stage is timed.

Tracks two logs of which the longer one begins with the shorter one, with one thread under callgrind, and divides the
difference by the number of scenes in it: what a start costs is left out. The milliseconds are of the longer log without
callgrind (timing.json), of stages by the clock, of all as CPU time with the start; other programs at work make them
longer, instructions stay the same.

  for n in 9 19; do build/bin/perception-import kitti ... --last $n -o out/k$n.rawlog; done
  tests/bench/speed/price.py -c ini/kitti.ini --set run.sensors=L out/k9.rawlog out/k19.rawlog [--base out/price.json]

Writes OUT/price.json. --base: that of another version; stages that grew by more than 5 % are marked.
"""
import argparse
import json
import os
import re
import subprocess
import sys

# Stages by the function that has them; what they call is theirs.
STAGES = {
    'read': r'RawlogReader::readEntry\(',
    'decode': r'Pipeline::addFrame\(',
    'ground': r'ScanMaker::addGround\(',
    'weather, trust': r'ScanMaker::weighReturns\(',
    'front ends': r'FrontEnd::extract\(',
    '- linking': r'perception::linkInSpace\(',
    '- descriptors': r'ClusterDescriber::describe\(',
    '- classifier': r'ClusterClassifier::probabilities\(',
    'filter': r'Pipeline::filter\(',
    '- likelihoods': r'perception::likelihoodTable\(',
    '- ranking': r'perception::rankChildren\(',
    'grid': r'Pipeline::addToGrid\(',
    'path, scene': r'Pipeline::addOutput\(',
    'result files': r'LogRun::put\(',
    'all': r'PROGRAM TOTALS',
}
TIMED = {'read': ['read'], 'decode': ['decode'], 'ground': ['ground'], 'weather, trust': ['weather', 'weather_state'],
         'front ends': ['lidar', 'radar', 'boxes'], 'filter': ['filter'], 'path, scene': ['scene']}
GROWN = 1.05


def track(args, log, out, under=()):
    command = list(under) + [args.track, '-c', args.config, '-i', log, '-o', out, '--threads', '1', '--overwrite']
    for value in args.set:
        command += ['--set', value]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: warnings
        sys.exit(done.stdout + done.stderr)
    with open(os.path.join(out, 'done.json')) as f:
        return json.load(f)['scenes']


def instructions(args, log, name):
    """Millions of instructions by stage, and the number of scenes."""
    out = os.path.join(args.output, name)
    counts = out + '.%p.callgrind'
    scenes = track(args, log, out, ['valgrind', '--tool=callgrind', '--callgrind-out-file=' + counts])
    files = [os.path.join(args.output, f) for f in os.listdir(args.output)
             if re.fullmatch(re.escape(name) + r'\.\d+\.callgrind', f)]
    largest = max(files, key=total)  # the supervisor's own is small
    text = subprocess.run(['callgrind_annotate', '--inclusive=yes', '--threshold=100', '--show-percs=no', largest],
                          capture_output=True, text=True, check=True).stdout
    for f in files:
        os.remove(f)
    cost = {}
    for stage, pattern in STAGES.items():
        lines = [line for line in text.splitlines() if re.match(r'\s*[\d,]+ +\S', line) and re.search(pattern, line)]
        found = [int(line.split()[0].replace(',', '')) for line in lines]
        cost[stage] = max(found, default=0) / 1e6
    return cost, scenes


def total(file):
    with open(file) as f:
        return max((int(line.split()[1]) for line in f if re.match(r'(summary|totals):', line)), default=0)


def milliseconds(args, log):
    out = os.path.join(args.output, 'timed')
    scenes = track(args, log, out)
    with open(os.path.join(out, 'timing.json')) as f:
        timing = json.load(f)
    seconds = {stage['name']: stage['seconds'] for stage in timing['stages']}
    of_stage = {stage: 1e3 * sum(seconds.get(n, 0) for n in names) / scenes for stage, names in TIMED.items()}
    return {**of_stage, 'all': 1e3 * timing['cpu_seconds'] / scenes}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('logs', nargs=2, help='the shorter one first')
    parser.add_argument('-c', '--config', required=True)
    parser.add_argument('-o', '--output', default='out/price')
    parser.add_argument('--set', action='append', default=[])
    parser.add_argument('--track', default='build/bin/perception-track')
    parser.add_argument('--base', help='price.json of another version')
    args = parser.parse_args()
    os.makedirs(args.output, exist_ok=True)
    base = {}
    if args.base:
        with open(args.base) as f:
            base = json.load(f)
    (short, few), (long, many) = (instructions(args, log, name) for log, name in zip(args.logs, ('short', 'long')))
    if many <= few:
        sys.exit('%s has no more scenes than %s' % (args.logs[1], args.logs[0]))
    times = milliseconds(args, args.logs[1])
    price = {stage: (long[stage] - short[stage]) / (many - few) for stage in STAGES}
    print('%-16s %14s %8s' % ('a scene', 'M instructions', 'ms'))
    for stage, cost in price.items():
        time = '%8.2f' % times[stage] if stage in times else ' ' * 8
        before = base.get(stage)
        said = '' if not before else '  before %.2f%s' % (before, ', GREW' if cost > GROWN * before else '')
        print('%-16s %14.2f %s%s' % (stage, cost, time, said))
    with open(os.path.join(args.output, 'price.json'), 'w') as f:
        json.dump(price, f, indent=1)


if __name__ == '__main__':
    main()
