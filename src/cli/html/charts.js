// The charts of a report. Every number in them, and every number that hovering shows, is one of the file.
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  for (const table of ['statistics', 'fan', 'static', 'survival', 'sub_phases', 'periods']) {
    if (data[table]) data[table] = Object.fromEntries(data[table]);
  }
  const place = document.getElementById('charts');
  const dark = () => {
    const chosen = document.documentElement.dataset.theme;
    return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  };
  const colours = () => dark()
    ? { ink: '#e8eaed', faint: '#9aa0aa', grid: '#2c323b', sheet: '#14171c', first: '#8ecaff', second: '#dd7a33', wide: '#1f3a52', narrow: '#33658f' }
    : { ink: '#16181c', faint: '#6a6f78', grid: '#e3e5e8', sheet: '#ffffff', first: '#0b4f8a', second: '#d55e00', wide: '#d3e5f3', narrow: '#8fbfe0' };
  const shown = (x) => x === null || x === undefined ? 'none' : String(x).replace('-', '\u2212');

  // A number as an axis shows it.
  const short = (x) => typeof x === 'string' ? x : (x !== 0 && Math.abs(x) < 1e-3 ? x.toExponential(0) : String(Number(x.toPrecision(4)))).replace('-', '\u2212');

  // A number at a logarithmic axis: a power of ten as such.
  const raised = (n) => String(n).replace(/./g, (c) => '\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079'['-0123456789'.indexOf(c)]);
  const power = (x) => {
    const n = Math.round(Math.log10(x));
    return Math.abs(x / 10 ** n - 1) > 1e-9 ? short(x) : n >= -1 && n <= 2 ? short(10 ** n) : `10${raised(n)}`;
  };

  // An area between two curves, drawn in one piece.
  const band = (name, colour, x, low, high) => ({
    name, type: 'custom', silent: true, clip: true, z: 1, itemStyle: { color: colour },
    data: x.map((at, i) => [at, low[i], high[i]]),
    encode: { x: 0, y: [1, 2], tooltip: [] }, dimensions: ['x', 'low', 'high'],
    renderItem: (params, api) => {
      if (params.dataIndexInside !== 0) return null;
      const floor = api.getHeight();
      const point = (i, k) => {
        const [px, py] = api.coord([x[i], (k ? high : low)[i]]);
        return [px, Number.isFinite(py) ? py : floor];
      };
      const there = x.map((_, i) => i).filter((i) => low[i] !== null && high[i] !== null);
      const points = there.map((i) => point(i, 0)).concat(there.reverse().map((i) => point(i, 1)));
      return { type: 'polygon', shape: { points }, style: { fill: colour } };
    },
  });
  const line = (name, colour, x, y, dash) => ({
    name, type: 'line', showSymbol: false, z: 3, data: x.map((at, i) => [at, y[i]]),
    lineStyle: { color: colour, width: 1.8, type: dash || 'solid' }, itemStyle: { color: colour },
  });
  const intervals = (colour, x, low, high) => ({
    name: '95 % interval', type: 'custom', silent: true, z: 4, itemStyle: { color: colour }, clip: true,
    data: x.map((at, i) => [at, low[i], high[i]]), encode: { x: 0, y: [1, 2], tooltip: [] },
    renderItem: (params, api) => {
      const i = params.dataIndex;
      if (low[i] === null || high[i] === null) return null;
      const [px, a] = api.coord([x[i], low[i]]);
      const bottom = Number.isFinite(a) ? a : api.getHeight();
      const b = api.coord([x[i], high[i]])[1];
      return { type: 'path', shape: { pathData: `M${px - 4},${bottom}h8m-4,0V${b}m-4,0h8` }, style: { stroke: colour, fill: 'none', lineWidth: 1.2 } };
    },
  });

  // Each chart has the columns of the file that it shows, and how they are drawn.
  const charts = [];
  if (data.fan) {
    const f = data.fan;
    charts.push({
      name: 'displacement', heading: 'Displacement', columns: f, x: 'time', xName: data.labels.time, yName: data.labels.displacement,
      note: 'Quantiles of the paths at each time, and their mean.',
      series: (c) => [band('5\u201395 %', c.wide, f.time, f.displacement_q05, f.displacement_q95),
        band('25\u201375 %', c.narrow, f.time, f.displacement_q25, f.displacement_q75),
        line('median', c.first, f.time, f.displacement_q50), line('mean', c.second, f.time, f.displacement_mean, 'dashed')],
    }, {
      name: 'static', heading: 'Probability of being static', columns: data.static, x: 'time', xName: data.labels.time, yName: 'P(static)', positive: true,
      note: 'Share of the paths in a static phase, with its 95 % interval.',
      series: (c) => [band('95 % interval', c.narrow, data.static.time, data.static.static_probability_low, data.static.static_probability_high),
        line('P(static)', c.first, data.static.time, data.static.static_probability)],
    });
  }
  if (data.survival) {
    const s = data.survival;
    const total = s.count.reduce((sum, n) => sum + n, 0);
    // Where durations are multiples of a step, the edges of a bin are moved to half a step beyond the multiples in it. Some bins hold no multiple.
    const edge = (x) => data.step === null ? x : (Math.max(Math.ceil(x / data.step - 1e-6), 1) - 0.5) * data.step;
    // The axis begins where one stick in two hundred is shorter.
    let shorter = 0;
    const first = s.count.findIndex((n) => (shorter += n) > total / 200);
    const from = s.lower[first] > 0 ? s.lower[first] : s.duration[first];
    const density = s.count.map((n, i) => {
      const [low, high] = [edge(s.lower[i]), edge(s.duration[i])];
      return low > 0 && high > low ? n / total / Math.log10(high / low) : null;
    });
    charts.push({
      name: 'survival', heading: 'Stick durations', columns: s, x: 'duration', xName: data.labels.duration, yName: 'share longer', log: 'x', from, values: s.survival, positive: true, canLog: true,
      note: data.sticks,
      series: (c) => [band('95 % interval', c.narrow, s.duration, s.survival_low, s.survival_high),
        line('Kaplan\u2013Meier', c.first, s.duration, s.survival)],
    }, {
      name: 'durations', heading: 'Density of stick durations', columns: s, x: 'duration', xName: data.labels.duration, yName: 'density per decade', log: 'x', from, values: density, positive: true, canLog: true,
      note: 'Completed sticks per decade of the duration, as a share of all, in the bins of the file, by the upper edge of the bin.',
      series: (c) => [{ ...line('completed sticks', c.first, s.duration, density), step: 'start', connectNulls: true, areaStyle: { color: c.wide, opacity: 1 } }],
    });
  }
  if (data.sub_phases) {
    const k = data.sub_phases;
    charts.push({
      name: 'sub-phases', heading: 'Sub-phases', columns: k, x: 'k', xName: 'sub-phases k of a slip', yName: 'share of the slips', category: true, values: k.share, positive: true, canLog: true,
      note: 'Share of the completed slips with k sub-phases, with its 95 % interval.',
      series: (c) => [{ name: 'share', type: 'bar', z: 2, itemStyle: { color: c.narrow }, data: k.k.map((n, i) => [String(n), k.share[i]]) },
        intervals(c.ink, k.k.map(String), k.share_low, k.share_high)],
    });
  }
  if (data.periods) {
    const p = data.periods;
    charts.push({
      name: 'periods', heading: 'Whole periods', columns: p, x: 'time', xName: data.labels.time, yName: data.labels.period, least: 0,
      note: data.drift,
      series: (c) => [{ ...line('mean of x(nP) \u2212 x(0)', c.first, p.time, p.mean), showSymbol: true, symbolSize: 7 },
        intervals(c.first, p.time, p.mean_low, p.mean_high)],
    });
  }

  const drawn = [];
  const draw = (chart, state) => {
    const c = colours();
    const narrow = state.box.clientWidth < 500;
    const axis = (title, isLog, hides) => ({
      name: title, nameLocation: 'middle', nameGap: 30, axisLine: { show: true, lineStyle: { color: c.ink } }, axisLabel: { color: c.ink, showMinLabel: hides ? false : chart.category, showMaxLabel: hides ? false : chart.category, formatter: isLog ? power : short, hideOverlap: true },
      minorTick: { show: isLog, splitNumber: 9 },
      nameTextStyle: { color: c.ink }, splitLine: { lineStyle: { color: c.grid } }, minorSplitLine: { show: false },
    });
    const all = chart.columns[chart.x];
    // A logarithmic axis begins at the power of ten below the smallest value.
    const least = state.log ? 10 ** Math.floor(Math.log10(Math.min(...chart.values.filter((v) => v > 0)))) : 0;
    state.chart.setOption({
      animation: false, aria: { enabled: true }, backgroundColor: c.sheet, textStyle: { color: c.ink, fontFamily: 'system-ui, sans-serif' },
      grid: { left: narrow ? 62 : 70, right: narrow ? 12 : 24, top: 40, bottom: 70 },
      legend: { top: 4, type: narrow ? 'scroll' : 'plain', textStyle: { color: c.ink } },
      toolbox: { show: !narrow, right: 8, top: 0, iconStyle: { borderColor: c.faint }, feature: { dataZoom: { filterMode: 'none', brushStyle: { color: c.wide } }, restore: {} } },
      dataZoom: [{ type: 'inside', filterMode: 'none', zoomOnMouseWheel: 'ctrl' }, { type: 'slider', filterMode: 'none', height: 14, bottom: 8, showDetail: false, showDataShadow: false }],
      tooltip: {
        trigger: 'axis', confine: true, renderMode: 'richText', backgroundColor: c.sheet, borderColor: c.grid, textStyle: { color: c.ink, fontSize: 12 },
        formatter: (items) => told(chart, items[0].dataIndex),
      },
      xAxis: { ...axis(chart.xName, chart.log === 'x', chart.log === 'x'), type: chart.category ? 'category' : chart.log === 'x' ? 'log' : 'value', ...(chart.category ? { data: all.map(String) } : { min: chart.least ?? chart.from ?? 'dataMin', max: chart.least === undefined ? 'dataMax' : null }) },
      yAxis: { ...axis(chart.yName, state.log), nameGap: 48, type: state.log ? 'log' : 'value', scale: !chart.positive, min: state.log ? least : chart.positive ? 0 : null, ...(state.log && { startValue: least }) },
      series: chart.series(c),
    }, true);
  };
  // The numbers of row i of the file, one on each line.
  const told = (chart, i) => Object.entries(chart.columns).map(([name, values]) => `${name} ${shown(values[i])}`).join('\n');

  const element = (name, text, parent) => {
    const made = document.createElement(name);
    if (text) made.textContent = text;
    parent.append(made);
    return made;
  };
  const save = (name, type, text) => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const csv = (columns) => {
    // Texts are quoted, so that a spreadsheet reads none as a formula or as two cells.
    const cell = (x) => x === null || x === undefined ? '' : typeof x === 'number' ? String(x) : `"${String(x).replace(/^([=+@-])/, "'$1").replaceAll('"', '""')}"`;
    const names = Object.keys(columns);
    const rows = columns[names[0]].map((_, i) => names.map((name) => cell(columns[name][i])).join(','));
    return [names.join(','), ...rows].join('\r\n') + '\r\n';
  };

  for (const chart of charts) {
    const section = element('section', '', place);
    section.id = chart.name;
    element('h2', chart.heading, section);
    const box = element('div', '', section);
    box.className = 'chart';
    box.tabIndex = 0;
    box.setAttribute('role', 'application');
    box.setAttribute('aria-label', `${chart.heading}: arrow keys move the cursor from value to value`);
    const line = element('p', '', section);
    line.className = 'told';
    line.setAttribute('aria-live', 'polite');
    element('p', chart.note, section).className = 'note';
    const buttons = element('p', '', section);
    const state = { chart: echarts.init(box, null, { renderer: 'svg' }), log: false, at: -1, box };
    const button = (text, act) => { const made = element('button', text, buttons); made.type = 'button'; made.addEventListener('click', act); };
    if (chart.canLog) button('Linear / log', () => { state.log = !state.log; draw(chart, state); });
    button('SVG', () => save(`${chart.name}.svg`, 'image/svg+xml', state.chart.renderToSVGString()));
    button('CSV', () => save(`${chart.name}.csv`, 'text/csv', csv(chart.columns)));
    draw(chart, state);
    drawn.push([chart, state]);
    box.addEventListener('keydown', (event) => {
      const last = chart.columns[chart.x].length - 1;
      const to = { ArrowRight: state.at + 1, ArrowLeft: state.at - 1, PageDown: state.at + 10, PageUp: state.at - 10, Home: 0, End: last }[event.key];
      if (event.key === 'Escape') { state.chart.dispatchAction({ type: 'hideTip' }); line.textContent = ''; return; }
      if (to === undefined) return;
      event.preventDefault();
      state.at = Math.min(Math.max(to, 0), last);
      const index = state.chart.getOption().series.findIndex((series) => series.type !== 'custom');
      state.chart.dispatchAction({ type: 'showTip', seriesIndex: index, dataIndex: state.at });
      line.textContent = told(chart, state.at).replaceAll('\n', ', ');
    });
  }
  const again = () => drawn.forEach(([chart, state]) => draw(chart, state));
  addEventListener('resize', () => drawn.forEach(([chart, state]) => { state.chart.resize(); draw(chart, state); }));
  addEventListener('beforeprint', () => drawn.forEach(([, state]) => state.chart.resize()));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', again);
  document.getElementById('theme').addEventListener('click', () => {
    document.documentElement.dataset.theme = dark() ? 'light' : 'dark';
    again();
  });
  document.querySelector('[data-csv=statistics]').addEventListener('click', () => save('statistics.csv', 'text/csv', csv(data.statistics)));
})();
