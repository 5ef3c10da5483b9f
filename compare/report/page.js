// Draws the report's charts from the page's JSON block, enlarges pictures, copies commands.
// The page reads without it. Everything here is drawing: all figures come computed.
"use strict";

(() => {
    const data = JSON.parse(document.getElementById("onepass-data").textContent);
    const kShapes = ["circle", "rect", "triangle", "rectRot", "star", "crossRot", "cross", "rectRounded"];
    const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const colour = (i) => {
        const colours = css("--series").split(/\s+/);
        return colours[i % colours.length];
    };
    const distinct = (values) => [...new Set(values)];
    const grouped = (n) => n.toLocaleString("en-US");
    const short = (v) => Number(v.toPrecision(3)).toLocaleString("en-US", { maximumSignificantDigits: 3 });
    const errorText = (n) => (n === 1 ? "1 error" : `${grouped(n)} errors`);

    // A log axis labels 1, 2 and 5 of each decade; more would collide.
    const logTick = (value) => {
        const lead = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
        return [1, 2, 5].some((digit) => Math.abs(lead - digit) < 1e-6) ? short(value) : null;
    };

    // Decades alone, where many of them share a short axis.
    const decadeTick = (value) => (Math.abs(Math.log10(value) % 1) < 1e-6 ? short(value) : null);

    // A log axis that ends a little beyond its data instead of at the next decade.
    const margins = (values, factor) => ({
        min: Math.min(...values.filter((v) => v > 0)) / factor,
        max: Math.max(...values) * factor,
    });

    const axis = (title, extra = {}) => ({
        title: { display: title !== "", text: title, color: css("--quiet") },
        grid: { color: css("--rule"), borderColor: css("--rule-strong") },
        ...extra,
        ticks: { color: css("--quiet"), ...extra.ticks },
    });

    const base = (scales, tooltip) => ({
        animation: false,
        maintainAspectRatio: false,
        scales,
        plugins: {
            legend: { display: false },
            tooltip: { callbacks: { title: () => "", label: tooltip } },
        },
    });

    // A legend in words below the chart, for labels that would not fit into it.
    function wordLegend(plot, datasets) {
        plot.parentElement.querySelector(".legend")?.remove();
        const list = document.createElement("ul");
        list.className = "legend";
        for (const dataset of datasets) {
            const mark = document.createElement("canvas");
            [mark.width, mark.height] = [44, 28];
            const ctx = mark.getContext("2d");
            ctx.strokeStyle = dataset.borderColor;
            ctx.fillStyle = dataset.backgroundColor;
            ctx.lineWidth = 3;
            Chart.helpers.drawPoint(ctx, { pointStyle: dataset.pointStyle, radius: 9, borderWidth: 3, rotation: 0 }, 22, 14);
            mark.setAttribute("aria-hidden", "true");
            const item = document.createElement("li");
            item.append(mark, dataset.label);
            list.append(item);
        }
        plot.after(list);
    }

    // Whiskers of a horizontal bar chart: dataset.interval[i] = [low, high].
    const whiskers = {
        id: "whiskers",
        afterDatasetsDraw(chart) {
            const { ctx, scales } = chart;
            ctx.save();
            ctx.strokeStyle = css("--ink");
            ctx.lineWidth = 1.5;
            chart.data.datasets.forEach((dataset, d) => {
                chart.getDatasetMeta(d).data.forEach((bar, i) => {
                    const [low, high] = dataset.interval[i];
                    if (low === null || high === null) return;
                    const [a, b] = [scales.x.getPixelForValue(low), scales.x.getPixelForValue(high)];
                    ctx.beginPath();
                    for (const x of [a, b]) {
                        ctx.moveTo(x, bar.y - 4);
                        ctx.lineTo(x, bar.y + 4);
                    }
                    ctx.moveTo(a, bar.y);
                    ctx.lineTo(b, bar.y);
                    ctx.stroke();
                });
            });
            ctx.restore();
        },
    };

    // The line at ratio 1, where a tracer is as fast as the oracle.
    const parity = {
        id: "parity",
        beforeDatasetsDraw({ ctx, scales, chartArea }) {
            const x = scales.x.getPixelForValue(1);
            if (x < chartArea.left || x > chartArea.right) return;
            ctx.save();
            ctx.strokeStyle = css("--rule-strong");
            ctx.setLineDash([4, 3]);
            ctx.beginPath();
            ctx.moveTo(x, chartArea.top);
            ctx.lineTo(x, chartArea.bottom);
            ctx.stroke();
            ctx.restore();
        },
    };

    const timings = data.timings.filter((t) => t.ratio !== null);
    const tracers = distinct(timings.map((t) => t.tracer));
    const raced = timings.filter((t) => !t.oracle);  // the oracle's own ratio is 1

    function ratios(plot) {
        const spread = Math.max(...raced.map((t) => t.ratio)) / Math.min(...raced.map((t) => t.ratio));
        const longest = Math.max(1, ...raced.map((t) => t.high ?? t.ratio));
        plot.style.height = `${raced.length * (raced.length > 16 ? 1.4 : 1.9) + 4.5}rem`;
        const narrow = plot.clientWidth < 640;
        const name = (t) => (narrow ? [t.tracer, `${t.scene}, ${t.rays}, ${errorText(t.errors)}`]
            : `${t.scene} ${t.rays} · ${t.tracer} · ${errorText(t.errors)}`);
        return {
            type: "bar",
            plugins: [whiskers, parity],
            data: {
                labels: raced.map(name),
                datasets: [{
                    data: raced.map((t) => t.ratio),
                    interval: raced.map((t) => [t.low, t.high]),
                    backgroundColor: raced.map((t) => colour(tracers.indexOf(t.tracer))),
                    barPercentage: 0.72,
                    categoryPercentage: 0.9,
                }],
            },
            options: {
                ...base({
                    x: axis("times Embree’s speed", spread > 30
                        ? { type: "logarithmic", ticks: { callback: logTick } } : { min: 0, suggestedMax: 1.08 * longest }),
                    y: axis("", { grid: { display: false }, ticks: { color: css("--ink"), autoSkip: false, font: { size: narrow ? 10 : 12 } } }),
                }, (item) => {
                    const t = raced[item.dataIndex];
                    return `${short(t.ratio)} (${short(t.low ?? NaN)} to ${short(t.high ?? NaN)}), ${errorText(t.errors)} in ${grouped(t.count)}`;
                }),
                indexAxis: "y",
            },
        };
    }

    // Upright strips behind the curves: the densities whose time is within a share of the best.
    const strips = (bands) => ({
        id: "strips",
        beforeDatasetsDraw({ ctx, scales, chartArea: { left, top, right, bottom } }) {
            ctx.save();
            ctx.fillStyle = css("--rule-strong");
            ctx.globalAlpha = 0.28;
            for (const { low, high } of bands) {
                const from = Math.max(left, scales.x.getPixelForValue(low));
                const to = Math.min(right, scales.x.getPixelForValue(high));
                ctx.fillRect(from, top, Math.max(2, to - from), bottom - top);
            }
            ctx.restore();
        },
    });

    function sweep(plot) {
        const study = data.sweeps[Number(plot.dataset.sweep)];
        const measure = plot.dataset.measure;
        const curves = distinct(study.points.map((p) => p.curve));
        const line = (curve, value) => study.points
            .filter((p) => p.curve === curve && (p[value] ?? null) !== null)
            .sort((a, b) => a.x - b.x)
            .map((p) => ({ x: p.x, y: p[value], errors: p.errors }));
        const datasets = curves.map((curve, i) => ({
            label: `${study.curve} ${short(curve)}`,
            data: line(curve, measure),
            borderColor: colour(i),
            backgroundColor: colour(i),
            pointStyle: kShapes[i % kShapes.length],
            borderWidth: 2,
            radius: 3.5,
            tension: 0,
        }));
        if (measure === "time") {
            // What the model says of the same sizes, and the sizes that somebody chose.
            curves.forEach((curve, i) => datasets.push({
                label: i === 0 ? "by the model" : "", data: line(curve, "predicted"), pointStyle: "line",
                borderColor: css("--quiet"), backgroundColor: "transparent", borderDash: [5, 4],
                borderWidth: 1.5, radius: 0, hoverRadius: 0, tension: 0,
            }));
            study.marks.forEach((mark, i) => datasets.push({
                label: mark.name, data: [{ x: mark.x, y: mark.time, errors: mark.errors }], showLine: false,
                pointStyle: ["star", "triangle", "rectRot", "rect"][i % 4], radius: 8, hoverRadius: 10,
                borderWidth: 2, borderColor: css("--ink"), backgroundColor: "transparent",
            }));
        }
        const options = base({
            x: axis(study.axis, { type: "logarithmic", ...margins(study.points.map((p) => p.x), 1.25), ticks: { callback: logTick, maxRotation: 0 } }),
            y: axis("", { min: 0, ticks: { maxTicksLimit: 6 } }),
        }, (item) => `${item.dataset.label}: λ ${short(item.raw.x)}: ${short(item.raw.y)}, ${errorText(item.raw.errors)}`);
        if (datasets.length > 1) {
            options.plugins.legend = {
                display: true,
                position: "bottom",
                labels: { color: css("--ink"), usePointStyle: true, boxHeight: 6, padding: 10, filter: (item) => item.text !== "" },
            };
        }
        return { type: "line", plugins: measure === "time" ? [strips(study.bands)] : [], data: { datasets }, options };
    }

    const claimsOf = (plot) => data.claims.filter((c) =>
        c.run === Number(plot.dataset.run) && c.entry === plot.dataset.entry);

    // One row a claim and quantity; the place says how far each measurement speaks for the claim.
    function claims(plot) {
        const kKinds = [
            { verdict: "holds", label: "speaks for the claim", shape: "circle", colour: "--good" },
            { verdict: "fails", label: "speaks against it", shape: "triangle", colour: "--bad" },
            { verdict: "depends", label: "decides nothing", shape: "rectRot", colour: "--flag" },
        ];
        const rowOf = (c, p) => `${c.id}: ${p.quantity}`;
        const points = claimsOf(plot).flatMap((c) => c.points
            .filter((p) => p.support !== null && p.support > 0)
            .map((p) => ({ ...p, x: p.support, y: rowOf(c, p) })));
        const rows = distinct(points.map((p) => p.y));
        plot.style.height = `${rows.length * 1.7 + 6}rem`;
        const datasets = kKinds.map((kind) => {
            const mine = points.filter((p) => p.verdict === kind.verdict);
            return {
                label: kind.label,
                data: mine,
                interval: mine.map((p) => [p.low, p.high]),
                pointStyle: kind.shape,
                radius: 6,
                hoverRadius: 8,
                borderWidth: 1.5,
                borderColor: css(kind.colour),
                backgroundColor: `${css(kind.colour)}66`,
            };
        });
        const options = base({
            x: axis("ratio over its bound, turned so that more speaks for the claim", {
                type: "logarithmic",
                ...margins(points.flatMap((p) => [p.low ?? p.x, p.high ?? p.x, 0.8, 1.25]), 1.2),
                ticks: { callback: logTick, maxRotation: 0 },
            }),
            y: axis("", { type: "category", labels: rows, offset: true, ticks: { color: css("--ink"), autoSkip: false } }),
        }, (item) => {
            const p = item.raw;
            return `${p.scene} ${p.work}, ${p.variant} / ${p.baseline}: ${short(p.ratio)}`;
        });
        options.plugins.legend = {
            display: true,
            position: "bottom",
            labels: { color: css("--ink"), usePointStyle: true, boxHeight: 7, padding: 16 },
            onClick: () => {},
        };
        return { type: "scatter", plugins: [whiskers, parity], data: { datasets }, options };
    }

    // Claims that run over a size: both times if every scene is a size of its own, else the ratio.
    function series(plot) {
        const claim = claimsOf(plot).find((c) => c.id === plot.dataset.claim);
        const points = claim.points.filter((p) => p.size > 0 && p.ratio !== null)
            .sort((a, b) => a.size - b.size);
        const scenes = distinct(points.map((p) => p.scene));
        const both = scenes.length === points.length;
        const curves = both
            ? [points[0].baseline, points[0].variant].map((label, i) =>
                ({ label, data: points.map((p) => ({ x: p.size, y: p.times[i] })) }))
            : scenes.map((scene) => ({
                label: scene,
                data: points.filter((p) => p.scene === scene).map((p) => ({ x: p.size, y: p.ratio })),
            }));
        const values = curves.flatMap((c) => c.data.map((p) => p.y));
        const options = base({
            x: axis(both ? "triangles" : "cells a triangle", { type: "logarithmic", ...margins(points.map((p) => p.size), 1.25), ticks: { callback: both ? decadeTick : logTick, maxRotation: 0 } }),
            y: axis(both ? "ms" : "", both ? { type: "logarithmic", ...margins(values, 1.4), ticks: { callback: decadeTick } } : { suggestedMin: 0.8, suggestedMax: 1.2 }),
        }, (item) => `${item.dataset.label}, ${short(item.raw.x)}: ${short(item.raw.y)}`);
        options.plugins.legend = {
            display: true,
            position: "bottom",
            labels: { color: css("--ink"), usePointStyle: true, boxHeight: 6, padding: 14 },
        };
        return {
            type: "line",
            data: {
                datasets: curves.map((curve, i) => ({
                    ...curve,
                    borderColor: colour(i),
                    backgroundColor: colour(i),
                    pointStyle: kShapes[i % kShapes.length],
                    borderWidth: 2,
                    radius: 3.5,
                })),
            },
            options,
        };
    }

    // Update and upload are to be seen beside a trace a thousand times as long: a logarithmic axis.
    function motion(plot) {
        const rows = data.motion;
        const parts = ["update", "upload", "trace"];
        plot.style.height = `${rows.length * 3.2 + 6}rem`;
        const times = rows.flatMap((r) => parts.map((part) => r[part])).filter((t) => t > 0);
        const options = base({
            x: axis("ms", { type: "logarithmic", ...margins(times, 1.6), ticks: { callback: logTick, maxRotation: 0 } }),
            y: axis("", { grid: { display: false }, ticks: { color: css("--ink"), autoSkip: false } }),
        }, (item) => `${item.dataset.label}: ${short(item.raw)} ms`);
        options.indexAxis = "y";
        options.plugins.legend = {
            display: true, position: "bottom", labels: { color: css("--ink"), boxHeight: 8, padding: 14 },
        };
        return {
            type: "bar",
            data: {
                labels: rows.map((r) => `${r.scene} · ${r.tracer}`),
                datasets: parts.map((part, i) => ({
                    label: part,
                    data: rows.map((r) => (r[part] > 0 ? r[part] : null)),
                    backgroundColor: colour([1, 4, 0][i]),
                    barPercentage: 0.9,
                    categoryPercentage: 0.7,
                })),
            },
            options,
        };
    }

    // Measured points, and their power laws as dashed lines: straight where both axes are logarithmic.
    function growth(plot) {
        const study = data.growth[Number(plot.dataset.growth)];
        const power = (line) => (line.exponent === null ? "" : `, slope ${line.exponent.toFixed(2).replace(/^-(0\.00)$/, "$1")}`);
        const points = study.lines.map((line) => ({
            label: `${line.name}${line.device ? " (device)" : ""}${power(line)}`,
            data: line.points,
            showLine: false,
            borderColor: colour(line.colour),
            backgroundColor: `${colour(line.colour)}99`,
            pointStyle: kShapes[line.colour % kShapes.length],
            radius: 4.5,
            hoverRadius: 6.5,
            borderWidth: 1.5,
        }));
        const laws = study.lines.map((line) => ({
            label: "",
            data: line.fit,
            borderColor: colour(line.colour),
            borderDash: [5, 4],
            borderWidth: 1.5,
            radius: 0,
            hoverRadius: 0,
        }));
        const all = study.lines.flatMap((line) => line.points);
        const options = base({
            x: axis(study.axis, { type: "logarithmic", ...margins(all.map((p) => p.x), 1.5), ticks: { callback: decadeTick, maxRotation: 0 } }),
            y: axis("", { type: "logarithmic", ...margins(all.map((p) => p.y), 1.8), ticks: { callback: decadeTick } }),
        }, (item) => `${item.dataset.label}: ${short(item.raw.y)} at ${grouped(item.raw.x)} ${study.axis}`);
        options.plugins.tooltip.filter = (item) => item.dataset.label !== "";
        wordLegend(plot, points);
        return { type: "line", data: { datasets: [...points, ...laws] }, options };
    }

    // The strip of an axis of rates where a rate of 0 is drawn, ...
    const zeroBand = (band, axisName) => ({
        id: "zeroBand",
        beforeDatasetsDraw({ ctx, scales, chartArea }) {
            const edge = scales[axisName].getPixelForValue(band.high);
            const { left, top, right, bottom } = chartArea;
            const lying = axisName === "y";
            ctx.save();
            ctx.fillStyle = css("--raised");
            if (lying) ctx.fillRect(left, edge, right - left, bottom - edge);
            else ctx.fillRect(left, top, edge - left, bottom - top);
            ctx.strokeStyle = css("--rule-strong");
            ctx.setLineDash([4, 3]);
            ctx.beginPath();
            ctx.moveTo(lying ? left : edge, lying ? edge : top);
            ctx.lineTo(lying ? right : edge, lying ? edge : bottom);
            ctx.stroke();
            ctx.restore();
        },
    });

    // ... and that axis: a tick for the strip, and one a decade that is not too close to it.
    const rateAxis = (title, band, max, none) => {
        const middle = Math.sqrt(band.low * band.high);
        return axis(title, {
            type: "logarithmic",
            min: band.low,
            max,
            afterBuildTicks: (scale) => {
                const decades = [...Array(16).keys()].map((k) => 10 ** -k).reverse();
                scale.ticks = [{ value: middle }, ...decades.filter((v) => v > 3 * band.high && v <= max).map((value) => ({ value }))];
            },
            ticks: { callback: (v) => (v < band.high ? none : share(v)), maxRotation: 0 },
        });
    };

    const share = (v) => (v === 0 ? "0" : `${(100 * v).toLocaleString("en-US", { maximumSignificantDigits: 3 })} %`);
    const failures = (p) => (p.failed === 0 ? `none of ${grouped(p.trials)}` : `${grouped(p.failed)} of ${grouped(p.trials)}`);

    // Where the knob's axis ends: the rungs beyond have no place on it.
    const unscaled = (from, rungs) => ({
        id: "unscaled",
        beforeDatasetsDraw({ ctx, scales, chartArea }) {
            const beyond = rungs.filter((x) => x > from);
            if (beyond.length === 0) return;
            const x = scales.x.getPixelForValue((from + Math.min(...beyond)) / 2);
            ctx.save();
            ctx.strokeStyle = css("--rule-strong");
            ctx.setLineDash([2, 4]);
            ctx.beginPath();
            ctx.moveTo(x, chartArea.top);
            ctx.lineTo(x, chartArea.bottom);
            ctx.stroke();
            ctx.restore();
        },
    });

    function ladder(plot) {
        const climb = data.ladders[Number(plot.dataset.ladder)];
        const narrow = plot.clientWidth < 640;
        const kin = {};  // of one colour, told apart by shape
        const datasets = climb.lines.map((line) => {
            const nth = (kin[line.colour] = (kin[line.colour] ?? -1) + 1);
            return {
                label: line.name,
                data: line.points,
                borderColor: colour(line.colour),
                backgroundColor: line.points.map((p) => (p.failed === 0 ? css("--ground") : colour(line.colour))),
                pointBorderColor: colour(line.colour),
                pointStyle: kShapes[nth % kShapes.length],
                borderWidth: line.twin ? 1.25 : 2,
                borderDash: line.twin ? [4, 3] : [],
                radius: line.twin ? 3 : 4,
                hoverRadius: 6,
                tension: 0,
            };
        });
        const [least, most] = climb.trials;
        const none = least === most ? `none of ${grouped(most)}` : [`none of ${grouped(least)}`, `to ${grouped(most)}`];
        const xs = climb.ticks.map((t) => t.x);
        const edge = 0.03 * Math.max(1e-9, Math.max(...xs) - Math.min(...xs)) || 1;
        const texts = new Map(climb.ticks.map((t) => [t.x, t.text]));
        // Ticks from the hard end on, as far as their words have room.
        const roomy = (scale) => {
            const pixels = (0.86 * scale.chart.width) / (Math.max(...xs) - Math.min(...xs) + 2 * edge);
            scale.ctx.save();
            scale.ctx.font = `12px ${Chart.defaults.font.family}`;
            const boxes = climb.ticks.map((t) => ({ x: t.x * pixels, half: scale.ctx.measureText(t.text).width / 2 + 5, value: t.x }));
            scale.ctx.restore();
            const kept = [];
            for (const box of boxes.sort((a, b) => b.x - a.x)) {
                const last = kept[kept.length - 1];
                if (!last || last.x - box.x > last.half + box.half) kept.push(box);
            }
            return kept.reverse().map(({ value }) => ({ value }));
        };
        const options = base({
            x: axis(climb.axis, {
                type: "linear",
                min: Math.min(...xs) - edge,
                max: Math.max(...xs) + edge,
                afterBuildTicks: (scale) => { scale.ticks = roomy(scale); },
                ticks: { callback: (v) => texts.get(v), autoSkip: false, maxRotation: 0 },
            }),
            y: rateAxis(narrow ? "" : "share of failures", climb.band, 1.5, narrow ? "none" : none),
        }, (item) => `${item.dataset.label}, ${item.raw.knob}: ${failures(item.raw)}`);
        options.plugins.legend = {
            display: true,
            position: "bottom",
            labels: { color: css("--ink"), usePointStyle: true, boxHeight: 6, padding: narrow ? 8 : 12, font: { size: narrow ? 10 : 12 } },
        };
        if (narrow) plot.style.height = "28rem";
        return { type: "line", plugins: [zeroBand(climb.band, "y"), unscaled(climb.scaled, xs)], data: { datasets }, options };
    }

    // Upright whiskers, dataset.interval[i] = [low, high]; and each point's number, put where it
    // covers neither a point nor another number.
    const upright = {
        id: "upright",
        afterDatasetsDraw(chart) {
            const { ctx, scales, chartArea } = chart;
            const points = chart.data.datasets.flatMap((dataset, d) => (dataset.interval
                ? chart.getDatasetMeta(d).data.map((p, i) => ({ p, dataset, i })) : []));
            ctx.save();
            ctx.lineWidth = 1.25;
            for (const { p, dataset, i } of points) {
                const [low, high] = dataset.interval[i];
                if (low === null || high === null) continue;
                ctx.strokeStyle = dataset.borderColor;
                ctx.beginPath();
                for (const y of [low, high].map((v) => scales.y.getPixelForValue(v))) {
                    ctx.moveTo(p.x - 3, y);
                    ctx.lineTo(p.x + 3, y);
                }
                ctx.moveTo(p.x, scales.y.getPixelForValue(low));
                ctx.lineTo(p.x, scales.y.getPixelForValue(high));
                ctx.stroke();
            }
            ctx.font = `600 12px ${Chart.defaults.font.family}`;
            ctx.fillStyle = css("--ink");
            ctx.strokeStyle = css("--ground");
            ctx.lineWidth = 3;
            ctx.textAlign = "center";
            ctx.textBaseline = "middle";
            const taken = points.map(({ p }) => ({ x: p.x, y: p.y, w: 6, h: 6 }));
            for (const { p, dataset, i } of points) {
                const text = String(dataset.data[i].number);
                const box = { w: 3 + 3.5 * text.length, h: 7 };
                const places = [[0, -15], [-10, -13], [10, -13], [-14, 0], [14, 0], [-10, 13], [10, 13], [0, 15], [26, 0], [-26, 0], [22, -15], [22, 15]]
                    .map(([x, y]) => ({ x: p.x + x + Math.sign(x) * (box.w - 6), y: p.y + y, ...box }))
                    .filter((a) => a.x - a.w > chartArea.left && a.x + a.w < chartArea.right);
                const free = places.find((a) => taken.every((b) =>
                    Math.abs(a.x - b.x) > a.w + b.w || Math.abs(a.y - b.y) > a.h + b.h)) ?? places[0];
                taken.push(free);
                ctx.strokeText(text, free.x, free.y);
                ctx.fillText(text, free.x, free.y);
            }
            ctx.restore();
        },
    };

    function tradeoff(plot) {
        const cloud = data.tradeoffs[Number(plot.dataset.cloud)];
        const narrow = plot.clientWidth < 640;
        const points = cloud.points.filter((p) => p.x !== null && p.ratio !== null).map((p) => ({ ...p, y: p.ratio }));
        const families = distinct(points.map((p) => p.colour));
        const datasets = families.flatMap((family) => [false, true].map((twin) => {
            const mine = points.filter((p) => p.colour === family && p.twin === twin);
            const name = mine[0]?.name.split(" ")[0].split("/");
            return {
                label: mine.length === 0 ? "" : `${name[0]}${name[0] === "embree" ? ` ${name[1]}` : ""}${twin ? ", twins" : ""}`,
                data: mine,
                interval: mine.map((p) => [p.low, p.high]),
                pointStyle: twin ? "triangle" : kShapes[family % 2 === 0 ? 0 : 1],
                radius: 5.5,
                hoverRadius: 7,
                borderWidth: 1.75,
                borderColor: colour(family),
                backgroundColor: mine.map((p) => (p.front ? colour(family) : `${colour(family)}44`)),
            };
        })).filter((d) => d.data.length > 0);
        const front = (member, label, dash) => ({
            label,
            data: points.filter((p) => p[member]).sort((a, b) => a.x - b.x),
            showLine: true,
            stepped: "before",
            radius: 0,
            hoverRadius: 0,
            pointStyle: "line",
            borderColor: css(dash.length ? "--quiet" : "--good"),
            backgroundColor: "transparent",
            borderWidth: dash.length ? 1.5 : 2.5,
            borderDash: dash,
        });
        const fronts = [front("front", "Pareto front", []), front("frontOfRest", "without Embree", [5, 4])]
            .filter((d) => d.data.length > 0);
        const right = Math.max(...points.map((p) => p.x), 20 * cloud.band.high);
        const rays = Math.max(...points.map((p) => p.count));
        const options = base({
            x: rateAxis("share of wrong answers", cloud.band, Math.min(1.5, 2 * right), narrow ? "none" : `none of ${grouped(rays)}`),
            y: axis(narrow ? "" : "times Embree’s speed", {
                type: "logarithmic",
                ...margins(points.flatMap((p) => [p.low ?? p.y, p.high ?? p.y]), 1.4),
                ticks: { callback: logTick },
            }),
        }, (item) => {
            const p = item.raw;
            return `${p.number}: ${p.name}: ${short(p.ratio)} (${short(p.low ?? NaN)} to ${short(p.high ?? NaN)}), ${errorText(p.errors)} in ${grouped(p.count)}`;
        });
        options.plugins.legend = {
            display: true,
            position: "bottom",
            labels: { color: css("--ink"), usePointStyle: true, boxHeight: 7, padding: narrow ? 8 : 14 },
            onClick: () => {},
        };
        return { type: "scatter", plugins: [zeroBand(cloud.band, "x"), upright], data: { datasets: [...datasets, ...fronts] }, options };
    }

    const makers = { ratios, sweep, claims, series, motion, growth, ladder, tradeoff };
    let charts = [];
    function draw() {
        charts.forEach((chart) => chart.destroy());
        Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
        charts = [...document.querySelectorAll("[data-chart]")].map((plot) => {
            const chart = new Chart(plot.querySelector("canvas"), makers[plot.dataset.chart](plot));
            plot.dataset.drawn = "true";
            return chart;
        });
    }
    draw();

    // Every chart can be kept as a picture, on a ground of its own.
    document.querySelectorAll("[data-chart]").forEach((plot, i) => {
        const button = document.createElement("button");
        button.type = "button";
        button.className = "saver";
        const name = plot.querySelector("canvas").getAttribute("aria-label").split(/[.:]/)[0];
        button.textContent = "Save as PNG";
        button.setAttribute("aria-label", `Save as PNG: ${name}`);
        button.addEventListener("click", () => {
            const source = charts[i].canvas;
            const copy = document.createElement("canvas");
            [copy.width, copy.height] = [source.width, source.height];
            const ctx = copy.getContext("2d");
            ctx.fillStyle = css("--ground");
            ctx.fillRect(0, 0, copy.width, copy.height);
            ctx.drawImage(source, 0, 0);
            const link = document.createElement("a");
            link.href = copy.toDataURL("image/png");
            link.download = `${name.toLowerCase().replace(/[^a-z0-9]+/g, "-")}.png`;
            link.click();
        });
        plot.closest("figure").append(button);
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
    matchMedia("print").addEventListener("change", draw);

    // ---- A closer look: two pictures under a divider, and what every tracer answered at a pixel.

    const hex = (n) => `#${n.toString(16).padStart(6, "0")}`;
    const cellOf = (tag, text, name = "") => {
        const cell = document.createElement(tag);
        cell.className = name;
        cell.textContent = text;
        return cell;
    };
    const swatched = (cell, text, className, colour) => {
        const swatch = document.createElement("span");
        swatch.className = `swatch ${className}`;
        if (colour) swatch.style.setProperty("--swatch", colour);
        swatch.textContent = text;
        cell.append(swatch);
        return cell;
    };

    // The pixels of a sheet: where they are, which are odd, and the answers at one as table rows.
    function sheetOf(sheet) {
        const column = (tracer, field) => (tracer[field] === undefined ? null : sheet.columns[tracer[field]]);
        const kErrors = ["false_miss", "false_hit", "wrong_surface", "t_error"];
        const places = sheet.pixels.map((p) => ({ x: p % sheet.width, y: Math.floor(p / sheet.width) }));
        const odd = places.map((_, i) => i)
            .filter((i) => sheet.tracers.some((tracer) => column(tracer, "class")[i] > 0));
        const rows = (i) => sheet.tracers.map((tracer) => {
            const at = (field) => column(tracer, field)?.[i];
            const name = sheet.classes[at("class")] ?? "none";
            const row = document.createElement("tr");
            const missed = at("inst") < 0;
            const heading = cellOf("th", tracer.name);
            heading.scope = "row";
            row.append(heading, swatched(cellOf("td", "", kErrors.includes(name) ? "text bad" : "text"), name, `class-${name}`));
            row.append(cellOf("td", missed ? "miss" : String(at("t"))));
            for (const field of ["prim", "inst"]) row.append(cellOf("td", missed ? "–" : String(at(field))));
            for (const field of ["cells", "tests"]) row.append(cellOf("td", at(field) === undefined ? "–" : grouped(at(field))));
            row.append(at("color") === undefined ? cellOf("td", "–", "text")
                : swatched(cellOf("td", "", "text"), hex(at("color")), "", hex(at("color"))));
            return row;
        });
        const culprit = sheet.tracers.find((tracer) => odd.some((i) => kErrors.includes(sheet.classes[column(tracer, "class")[i]])))?.name;
        return { places, odd, rows, culprit, width: sheet.width, height: sheet.height };
    }

    function closer(root) {
        const model = data.closer[Number(root.dataset.closer)];
        const stage = root.querySelector(".stage");
        const [left, right] = ["left", "right"].map((side) => root.querySelector(`[data-side=${side}]`));
        const [under, over] = [stage.querySelector(".under"), stage.querySelector(".over")];
        const options = [...root.querySelector("template.layers").content.querySelectorAll("option")];
        if (options.length === 0) return;

        // The two pictures: the oracle's on the left; on the right who is first to err.
        for (const select of [left, right]) {
            for (const group of distinct(options.map((o) => o.dataset.group))) {
                const list = document.createElement("optgroup");
                list.label = group;
                list.append(...options.filter((o) => o.dataset.group === group).map((o) => o.cloneNode(true)));
                select.append(list);
            }
        }
        const isOracle = (option) => option.dataset.group === "Image" && option.textContent.startsWith("embree/");
        left.selectedIndex = Math.max(0, [...left.options].findIndex(isOracle));
        const show = (image, select) => {
            const option = select.selectedOptions[0];
            image.src = document.getElementById(option.value).src;
            image.alt = `${option.dataset.group}, ${option.textContent}`;
        };
        const slider = root.querySelector("input[type=range]");
        const divide = () => {
            over.style.clipPath = `inset(0 0 0 ${slider.value}%)`;
            stage.querySelector(".divider").style.left = `${slider.value}%`;
            slider.setAttribute("aria-valuetext", `${slider.value} % of the picture is ${left.selectedOptions[0].textContent}`);
        };
        const refresh = () => { show(under, left); show(over, right); divide(); };
        for (const select of [left, right]) select.addEventListener("change", refresh);
        slider.addEventListener("input", divide);
        const first = model.sheet && sheetOf(model.sheet).culprit;
        right.selectedIndex = Math.max(0, [...right.options].findIndex((o) => o.textContent === first));
        refresh();
        root.hidden = false;
        if (!model.sheet) return;

        // The pixels.
        const sheet = sheetOf(model.sheet);
        const reading = root.querySelector(".reading");
        const cursor = stage.querySelector(".cursor");
        let current = sheet.odd[0] ?? 0;
        const pick = (i) => {
            current = i;
            const { x, y } = sheet.places[i];
            cursor.hidden = false;
            cursor.style.left = `${(100 * (x + 0.5)) / sheet.width}%`;
            cursor.style.top = `${(100 * (y + 0.5)) / sheet.height}%`;
            const nth = sheet.odd.indexOf(i);
            root.querySelector(".where").textContent = `Pixel (${x}, ${y})` +
                (nth < 0 ? ": all agree." : `: odd pixel ${grouped(nth + 1)} of ${grouped(sheet.odd.length)}.`);
            root.querySelector(".reading tbody").replaceChildren(...sheet.rows(i));
            root.querySelector(".explain").textContent =
                `onepass explain ${model.scene} --pixel ${x},${y} --size ${sheet.width}x${sheet.height}`;
        };
        const nearest = (cost) => {
            let best = -1, least = Infinity;
            sheet.places.forEach((place, i) => {
                const c = cost(place);
                if (c < least) [best, least] = [i, c];
            });
            return best;
        };
        stage.addEventListener("click", (event) => {
            const box = stage.getBoundingClientRect();
            const x = ((event.clientX - box.left) / box.width) * sheet.width - 0.5;
            const y = ((event.clientY - box.top) / box.height) * sheet.height - 0.5;
            pick(nearest((p) => (p.x - x) ** 2 + (p.y - y) ** 2));
        });
        const kSteps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
        stage.addEventListener("keydown", (event) => {
            const step = kSteps[event.key];
            if (!step) return;
            event.preventDefault();
            const { x, y } = sheet.places[current];
            const next = nearest((p) => {
                const [dx, dy] = [p.x - x, p.y - y];
                const along = dx * step[0] + dy * step[1];
                return along > 0 ? along + 3 * Math.abs(dx * step[1] + dy * step[0]) : Infinity;
            });
            if (next >= 0) pick(next);
        });
        for (const button of root.querySelectorAll("[data-walk]")) {
            button.disabled = sheet.odd.length === 0;
            button.addEventListener("click", () => {
                const step = Number(button.dataset.walk);
                const count = sheet.odd.length;
                const after = sheet.odd.findIndex((i) => (step > 0 ? i > current : i >= current));
                const at = (after < 0 ? count : after) + (step > 0 ? 0 : -1);
                pick(sheet.odd[(at + count) % count]);
            });
        }
        root.querySelector(".left-out").textContent = `${grouped(sheet.places.length)} pixels are kept: a lattice, and the odd ones` +
            (model.left_out > 0 ? `, of which ${grouped(model.left_out)} had no room.` : ".");
        reading.hidden = false;
        pick(current);
    }
    document.querySelectorAll("[data-closer]").forEach(closer);

    // Pictures, enlarged with their pixels visible.
    const viewer = document.getElementById("viewer");
    for (const button of document.querySelectorAll(".zoom")) {
        button.addEventListener("click", () => {
            viewer.querySelector("img").src = button.querySelector("img").src;
            viewer.querySelector("img").alt = button.querySelector("img").alt;
            viewer.querySelector("p").textContent = button.querySelector("img").alt;
            viewer.showModal();
        });
    }
    viewer.addEventListener("click", (event) => {
        if (event.target === viewer) viewer.close();
    });

    // A button beside every text that is worth copying.
    for (const code of document.querySelectorAll("code.copy")) {
        const button = document.createElement("button");
        button.type = "button";
        button.className = "copier";
        button.textContent = "Copy";
        button.addEventListener("click", async () => {
            try {
                await navigator.clipboard.writeText(code.textContent);
                button.textContent = "Copied";
            } catch {
                getSelection().selectAllChildren(code);
                button.textContent = "Selected";
            }
            setTimeout(() => { button.textContent = "Copy"; }, 1500);
        });
        code.after(button);
    }
})();
