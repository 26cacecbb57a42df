#pragma once

namespace perception {

/// CSS of the page of a batch, beside that of a run's page.
inline constexpr const char* kBatchStyle = R"css(
.wide { overflow-x: auto; }
th { cursor: pointer; white-space: nowrap; }
td.number, th.number { text-align: right; }
tr.failed td, tr.missing td { background: #fbeee6; }
td.reason { max-width: 420px; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
#histogram { height: 190px; cursor: default; }
#histogram rect { fill: #0072b2; }
#histogram rect:hover { fill: #d55e00; }
select, input { font: inherit; margin: 0 0 8px 0; max-width: 100%; box-sizing: border-box; }
)css";

inline constexpr const char* kBatchBody = R"html(
<h2>One figure over all shards</h2>
<p><select id="figure" aria-label="figure"></select></p>
<svg id="histogram" role="img" aria-label="histogram"></svg>
<p id="ends"></p>
<div class="wide"><table id="conditions"></table></div>
<h2>All shards</h2>
<p>A click on a heading sorts. <input id="filter" placeholder="part of a log, state, ..."
aria-label="filter"></p>
<div class="wide"><table id="shards"></table></div>
)html";

/// Histogram, extremes and means of the chosen figure; the table, sorted and filtered. Names as
/// they come go into the page as text, never as HTML.
inline constexpr const char* kBatchScript = R"js(
(function () {
  var data = JSON.parse(document.getElementById('data').textContent);
  var at = function (id) { return document.getElementById(id); };
  var column = function (name) { return data.columns.indexOf(name); };
  var titles = {'closest.all.object_tracked_a': 'tracked', 'closest.all.correct': 'right class',
    'closest.all.mis': 'wrong class', 'closest.all.position_rms_m': 'position rms [m]',
    'one_to_one.all.id_switches': 'id switches',
    'false_objects.all.per_instant': 'false an instant', 'set_distance.gospa_mean_m': 'GOSPA [m]'};
  var shown = Object.keys(titles).filter(function (f) { return data.figures.indexOf(f) >= 0; });
  var columns = ['id', 'log', 'config', 'sensors', 'particles', 'seed', 'state'].concat(shown,
    ['tracks', 'warnings', 'reason']);
  var chosen = 0, sorted = 'log', down = false;
  function add(parent, tag, text, attributes) {
    var svg = parent.namespaceURI.indexOf('svg') > 0;
    var e = svg ? document.createElementNS(parent.namespaceURI, tag) : document.createElement(tag);
    if (text !== undefined && text !== null) e.textContent = text;
    for (var name in attributes || {}) e.setAttribute(name, attributes[name]);
    return parent.appendChild(e);
  }
  function short(value) {
    if (value === null) return 'n/a';
    return value === Math.round(value) ? String(value) : value.toFixed(3);
  }
  function nameOf(shard) {
    var sensors = shard.cells[column('sensors')], log = shard.cells[column('log')];
    return [log.split('/').pop(), sensors, shard.cells[column('particles')] + ' particles',
      'seed ' + shard.cells[column('seed')]].join(', ');
  }
  function link(parent, shard, text) {
    return shard.link ? add(parent, 'a', text, {href: shard.link}) : add(parent, 'span', text);
  }
  function withFigure() {
    return data.shards.filter(function (s) { return typeof s.figures[chosen] === 'number'; })
      .sort(function (a, b) { return a.figures[chosen] - b.figures[chosen]; });
  }
  function histogram() {
    var chart = at('histogram'), all = withFigure(), bins = [], k;
    var wide = Math.max(200, chart.clientWidth), inside = wide - 40;
    chart.textContent = '';
    chart.setAttribute('viewBox', '0 0 ' + wide + ' 190');
    if (!all.length) return;
    var low = all[0].figures[chosen], high = all[all.length - 1].figures[chosen];
    var count = Math.min(30, Math.max(1, Math.ceil(2 * Math.sqrt(all.length))));
    if (high === low) count = 1;
    for (k = 0; k < count; ++k) bins.push(0);
    all.forEach(function (s) {
      var place = high > low ? (s.figures[chosen] - low) / (high - low) * count : 0;
      ++bins[Math.min(count - 1, Math.floor(place))];
    });
    var most = Math.max.apply(null, bins), width = inside / count;
    bins.forEach(function (n, i) {
      var tall = 140 * n / most, from = low + (high - low) * i / count;
      var bar = add(chart, 'rect', null, {x: 20 + i * width + 1, y: 160 - tall,
        width: Math.max(1, width - 2), height: tall});
      add(bar, 'title', short(from) + ' to ' + short(from + (high - low) / count) + ': ' + n);
      if (n) add(chart, 'text', n, {x: 20 + (i + .5) * width, y: 154 - tall,
        'text-anchor': 'middle'});
    });
    add(chart, 'text', short(low), {x: 20, y: 180});
    add(chart, 'text', short(high), {x: 20 + inside, y: 180, 'text-anchor': 'end'});
  }
  function ends() {
    var all = withFigure(), box = at('ends'), k;
    box.textContent = all.length ? '' : 'No shard has figures: no truth beside the logs.';
    [['lowest: ', all.slice(0, 5)], ['highest: ', all.slice(-5).reverse()]].forEach(function (end) {
      if (!all.length) return;
      add(box, 'b', end[0]);
      end[1].forEach(function (s, i) {
        if (i) add(box, 'span', '; ');
        link(box, s, nameOf(s) + ': ' + short(s.figures[chosen]));
      });
      add(box, 'br');
    });
  }
  function conditions() {
    var table = at('conditions'), by = {}, head;
    table.textContent = '';
    withFigure().forEach(function (s) {
      var key = [s.cells[column('config')].split('/').pop(), s.cells[column('sensors')],
        s.cells[column('particles')]].join('|');
      (by[key] = by[key] || []).push(s.figures[chosen]);
    });
    head = add(table, 'tr');
    ['config', 'sensors', 'particles', 'shards', 'mean', 'least', 'largest'].forEach(
      function (text, i) { add(head, 'th', text, i > 1 ? {'class': 'number'} : {}); });
    Object.keys(by).sort().forEach(function (key) {
      var row = add(table, 'tr'), v = by[key], sum = v.reduce(function (a, b) { return a + b; }, 0);
      key.split('|').concat([v.length, short(sum / v.length), short(v[0]), short(v[v.length - 1])])
        .forEach(function (text, i) { add(row, 'td', text, i > 1 ? {'class': 'number'} : {}); });
    });
  }
  function valueOf(shard, name) {
    var c = column(name);
    return c >= 0 ? shard.cells[c] : shard.figures[data.figures.indexOf(name)];
  }
  function compare(a, b) {
    var x = valueOf(a, sorted), y = valueOf(b, sorted), none = function (v) {
      return v === null || v === ''; };
    if (none(x) || none(y)) return none(x) - none(y);  // at the end either way
    var order = isNaN(x) || isNaN(y) ? (x < y ? -1 : x > y ? 1 : 0) : x - y;
    return down ? -order : order;
  }
  function shards() {
    var table = at('shards'), head, part = at('filter').value.toLowerCase();
    table.textContent = '';
    head = add(table, 'tr');
    columns.forEach(function (name) {
      var figure = column(name) < 0, mark = name === sorted ? (down ? ' \u25bc' : ' \u25b2') : '';
      add(head, 'th', (titles[name] || name) + mark, figure ? {'class': 'number'} : {})
        .addEventListener('click', function () {
          down = name === sorted ? !down : figure;
          sorted = name;
          shards();
        });
    });
    data.shards.filter(function (s) {
      return s.cells.join(' ').toLowerCase().indexOf(part) >= 0;
    }).sort(compare).forEach(function (s) {
      var row = add(table, 'tr', null, {'class': s.cells[column('state')]});
      columns.forEach(function (name) {
        var value = valueOf(s, name), figure = column(name) < 0;
        var box = add(row, 'td', null, {'class': figure ? 'number' : name});
        if (name === 'id') return link(box, s, value);
        box.textContent = figure ? short(value)
          : name === 'log' || name === 'config' ? value.split('/').pop() : value;
        box.title = value;
      });
    });
  }
  function figure() { histogram(); ends(); conditions(); }
  at('figure').hidden = !data.figures.length;
  if (!data.figures.length) at('histogram').style.display = 'none';
  data.figures.forEach(function (name, i) {
    add(at('figure'), 'option', titles[name] ? titles[name] + ' (' + name + ')' : name, {value: i});
  });
  chosen = Math.max(0, data.figures.indexOf(shown[0]));
  at('figure').value = chosen;
  at('figure').addEventListener('change', function () { chosen = +this.value; figure(); });
  at('filter').addEventListener('input', shards);
  window.addEventListener('resize', histogram);
  figure();
  shards();
})();
)js";

}  // namespace perception
