// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { App } from './app';
import { triangleBudget } from './budgets';
import { DesktopTool } from './input/desktop_tool';
import { FollowTool } from './input/follow_tool';
import { Navigation } from './input/navigation';
import { Picking } from './input/picking';
import type { ReplayPlayer } from './replay/replay';
import { makeCloud, makeOccupancy } from './scene/cells';
import { SceneLoader, type Progress } from './scene/loading';
import type { LayerName } from './scene/layers';
import type { TileStream } from './scene/tile_stream';
import { addMarks } from './scene/marks';
import type { ViewSide } from './scene/view';
import { fetchBytes, hasScan, type SceneModel, type SessionInfo } from './scene/scene_model';
import { Measured, type Comparison } from './session/measured';
import { RestartCheck } from './session/restart';
import { TestHook } from './test_hook';
import { armText } from './ui/arm_text';
import { byId, setPressed, setText } from './ui/dom';
import { length, megabytes } from './ui/format';
import { Hud } from './ui/hud';
import { Labels } from './ui/labels';
import { LinkPanel } from './ui/link_panel';
import { fillDetail, fillLayersPanel, presentLayers } from './ui/layers_panel';
import { addTrackedLegend, fillHeightLegend, fillLegend } from './ui/legend';
import type { LivePlot } from './ui/live_plot';
import type { Messages } from './ui/messages';
import { differenceText, MeasureLabels } from './ui/measure_labels';
import { ObjectsPanel, phaseLabel } from './ui/objects_panel';
import { PageLink } from './ui/page_link';
import { PlotGrip } from './ui/plot_grip';
import { pair } from './ui/pairing';
import { RobotPicture } from './ui/robot_picture';
import { savePicture } from './ui/save_picture';
import { Sheet } from './ui/sheet';
import { addShortcuts } from './ui/shortcuts';
import type { Theme, ThemeSwitch } from './ui/theme';
import { ToolPanel } from './ui/tool_panel';
import type { Caption } from './ui/video_caption';
import { ViewVideo } from './ui/view_video';

const statsSeconds = 0.25; // between updates of the displayed numbers, so that they can be read
const vibrationMs = 30;

/// A page in one file has no server, and no tiles: it does without their code.
declare const IS_ONE_FILE: boolean;

/// The page around the 3D view: panels, navigation, tool, session.
export class Page {
  private readonly hook: TestHook;
  private readonly loader: SceneLoader;
  private readonly navigation: Navigation;
  private readonly picking: Picking;
  private readonly follow: FollowTool;
  private readonly objects: ObjectsPanel;
  private readonly labels: Labels;
  private readonly hud: Hud;
  private readonly restart: RestartCheck;
  private readonly measured: MeasureLabels;
  private readonly link: PageLink;
  private readonly isReplay: boolean;
  private readonly showDetail: (level: number) => void;
  private readonly reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  private tool: DesktopTool | null = null;
  private toolPanel: ToolPanel | null = null;
  private linkPanel: LinkPanel | null = null;
  private robotPicture: RobotPicture | null = null;
  private replay: ReplayPlayer | null = null;
  private tiles: TileStream | null = null;
  private plot: LivePlot | null = null;
  private makePlot: ((hasRobot: boolean) => void) | null = null;
  private lastStats = -Infinity; // [ms]
  private pulses = -1;
  private hasFirstFrame = false;
  private hadState = false;
  private readonly measuredState = new Measured();
  private readonly legend = byId('phase-legend', HTMLParagraphElement);
  private readonly enableLayer: (name: LayerName) => void;
  private isLinkRestored = false;

  constructor(
    private readonly app: App,
    private readonly model: SceneModel,
    info: SessionInfo,
    private readonly messages: Messages,
    theme: ThemeSwitch,
  ) {
    const { view, session } = app;
    this.isReplay = info.mode === 'replay';
    app.showsLiveState = !this.isReplay;
    this.loader = new SceneLoader(
      view,
      (progress) => this.showProgress(progress),
      () => this.partLoaded(),
      (text) => messages.show({ level: 'error', text }),
    );
    this.hook = window.__pcavr = new TestHook(app, this.loader);
    this.navigation = new Navigation(app.camera, app.canvas, () => app.invalidate());
    this.follow = new FollowTool(app, this.navigation, () => this.tool?.isPointed ?? false);
    this.picking = new Picking(view, app.canvas, () => app.invalidate());
    this.objects = new ObjectsPanel(view.bodies, (text) => messages.announce(text));
    this.labels = new Labels(view, byId('stage', HTMLElement));
    this.measured = new MeasureLabels(view, byId('stage', HTMLElement));
    this.hud = new Hud(session, () => this.linkPanel?.delays() ?? []);
    this.restart = new RestartCheck((text) => messages.show({ level: 'warning', text }));
    addMarks(view, model);
    // Without a scan only the support planes show what the bodies stand on.
    if (!hasScan(model)) view.layers.show('planes', true);
    this.enableLayer = fillLayersPanel(view.layers, presentLayers(model, this.isReplay));
    view.layers.onChange(() => app.invalidate());
    this.showDetail = fillDetail(model, (level) => void this.loader.choose(level));
    fillLegend(this.legend);
    if (this.isReplay) addTrackedLegend(this.legend, 'outline: tracked pose');
    this.loadOnDemand();
    this.link = new PageLink(view, this.navigation, () => this.replay?.timeline ?? null);
    this.link.restoreLayers();
    this.fillHead(info);
    this.connectView();
    this.connectSession();
    this.setTheme(theme.theme());
    theme.onChange = (chosen) => this.setTheme(chosen);
    app.onFrame((time, seconds) => this.frame(time, seconds));
    app.onDrawn(() => this.drawn());
    app.onBlind((isBlind) => this.showBlind(isBlind));
  }

  async load(): Promise<void> {
    const { tiles } = this.model;
    const loading = Promise.all([
      this.loader.load(triangleBudget(this.app.isSoftwareRendered)),
      tiles ? this.streamTiles(tiles.path) : undefined,
    ]);
    if (this.isReplay) await this.loadReplay();
    else await this.addTool();
    new PlotGrip();
    await loading;
    this.frameAtFirst();
    const time = this.link.restoreView();
    if (time !== undefined) this.replay?.seek(time);
    this.isLinkRestored = true;
    // Until the user turns the view, it follows the window's shape.
    new ResizeObserver(() => this.frameAtFirst()).observe(byId('stage', HTMLElement));
  }

  /// Loads of a tiled scan what is seen, from now on.
  private async streamTiles(path: string): Promise<void> {
    if (!IS_ONE_FILE) {
      const { streamTiles } = await import('./scene/tile_stream');
      this.tiles = this.hook.tiles = streamTiles(
        this.app,
        path,
        () => this.partLoaded(),
        (text) => this.messages.show({ level: 'error', text }),
      );
    }
  }

  private async loadReplay(): Promise<void> {
    const { ReplayPlayer } = await import('./replay/replay');
    this.replay = this.hook.replay = await ReplayPlayer.load(this.app);
  }

  private async addTool(): Promise<void> {
    const handle = byId('handle', HTMLButtonElement);
    const heightHandle = byId('height-handle', HTMLButtonElement);
    this.tool = new DesktopTool(this.app, this.picking, handle, heightHandle);
    this.tool.isEnabled = true;
    this.toolPanel = new ToolPanel(this.app, this.tool, handle, heightHandle);
    const { tool } = this;
    this.linkPanel = new LinkPanel(this.app, () => tool.disengage());
    this.robotPicture = new RobotPicture();
    const { LivePlot } = await import('./ui/live_plot');
    byId('dock', HTMLElement).hidden = false;
    // With the first state it is known whether there is a robot whose force is measured.
    this.makePlot = (hasRobot) =>
      (this.plot = new LivePlot(byId('plots', HTMLDivElement), this.model, hasRobot));
    const state = this.app.session.latest();
    if (this.hadState) this.makePlot(Boolean(state?.link));
  }

  private fillHead(info: SessionInfo): void {
    setText(byId('scene-name', HTMLSpanElement), this.model.name || info.scene);
    const chip = byId('mode', HTMLSpanElement);
    chip.hidden = false;
    chip.textContent = info.mode;
    document.title = `${this.model.name || info.scene} · pcavr`;
    new Sheet();
  }

  private connectView(): void {
    for (const radio of document.querySelectorAll<HTMLInputElement>('[name=navigation]'))
      radio.addEventListener('change', () =>
        this.navigation.setMode(radio.value as 'orbit' | 'walk'),
      );
    byId('frame-all', HTMLButtonElement).addEventListener('click', () => this.frameAll());
    for (const button of document.querySelectorAll<HTMLButtonElement>('[data-side]')) {
      const side = button.dataset.side as ViewSide;
      button.hidden = side === 'camera' && this.model.cameras.length === 0;
      button.addEventListener('click', () => this.lookFrom(side));
    }
    byId('save-picture', HTMLButtonElement).addEventListener('click', () =>
      savePicture(this.app, this.model.name),
    );
    new ViewVideo(this.app, this.model.name, () => this.caption());
    const follow = byId('follow-tool', HTMLButtonElement);
    follow.addEventListener('click', () => {
      this.follow.isOn = !this.follow.isOn;
      setPressed(follow, this.follow.isOn);
    });
    addShortcuts(this.isReplay);
    const measure = byId('measure', HTMLButtonElement);
    const distance = byId('distance', HTMLOutputElement);
    measure.addEventListener('click', () => {
      this.picking.setMeasuring(!this.picking.isMeasuring);
      setPressed(measure, this.picking.isMeasuring);
      setText(
        distance,
        this.picking.isMeasuring ? 'click two points' : 'between two points, in mm',
      );
    });
    this.picking.onMeasure = ([a, b]) =>
      setText(distance, b ? differenceText(a, b) : 'click the second point');
    this.picking.onPick = (body) => {
      if (body || this.objects.selected) this.objects.select(body ?? this.objects.selected);
    };
  }

  private connectSession(): void {
    const { session, view } = this.app;
    session.onWelcome((welcome) => {
      void this.restart.onWelcome(welcome);
      view.setObjectOrder(welcome.objects);
      view.tool.setRadius(welcome.tool_radius);
    });
    session.onNotice((notice) => this.messages.show(notice));
    session.onConnection((connection, reason) => {
      this.showConnection();
      this.app.invalidate(); // the state of the tool's buttons may have changed
      if (reason && connection === 'refused') this.messages.show({ level: 'error', text: reason });
      this.showLost(connection === 'lost');
      // A restarted server has a new pairing code; while it is down, the worker keeps reconnecting.
      if (connection === 'lost') pair().catch(() => undefined);
    });
  }

  /// Of the page with its server, and of an operator's site with the robot's.
  private showConnection(): void {
    const { connection } = this.app.session;
    const isRobotLost = connection === 'open' && (this.linkPanel?.isLost ?? false);
    const status = byId('connection', HTMLSpanElement);
    status.dataset.state = isRobotLost ? 'lost' : connection;
    const texts = {
      open: isRobotLost ? "no link to the robot's site" : 'connected',
      lost: 'disconnected, reconnecting',
      refused: 'refused',
      connecting: 'connecting',
    };
    setText(status, texts[connection]);
  }

  /// Dims the scene, and shows that phases and forces are not known. A replay goes on.
  private showLost(isLost: boolean): void {
    if (this.isReplay) return;
    byId('lost', HTMLElement).hidden = !isLost;
    if (!isLost) return;
    this.app.view.forgetState();
    this.plot?.clear();
    this.lastStats = -Infinity; // shown with the next frame
  }

  /// Without a picture nobody may move the tool: the clutch opens until there is one again.
  private showBlind(isBlind: boolean): void {
    byId('no-picture', HTMLElement).hidden = !isBlind;
    if (!this.tool) return;
    this.tool.disengage();
    this.tool.isEnabled = !isBlind;
  }

  /// Fetches the point cloud and the occupancy cells when their layer is first shown.
  private loadOnDemand(): void {
    const { layers } = this.app.view;
    const { cloud, occupancy } = this.model;
    const sources = {
      cloud: cloud && { path: cloud.path, make: makeCloud },
      occupancy: occupancy && { path: occupancy.path, make: makeOccupancy },
    };
    layers.onChange(async (name, isShown) => {
      if (name === 'occupancy') byId('height-legend', HTMLElement).hidden = !isShown;
      if (!isShown || (name !== 'cloud' && name !== 'occupancy')) return;
      const source = sources[name];
      if (!source) return;
      sources[name] = null;
      try {
        const cells = source.make(await fetchBytes(source.path, () => {}));
        layers.group(name).add(cells);
        if (name === 'occupancy') fillHeightLegend(cells.userData.heights);
        this.app.invalidate();
      } catch (error) {
        this.messages.show({ level: 'error', text: `${source.path}: ${(error as Error).message}` });
      }
    });
  }

  private setTheme(theme: Theme): void {
    this.app.view.setTheme(theme);
    this.app.invalidate();
  }

  private lookFrom(side: ViewSide): void {
    this.navigation.hasMoved = true;
    this.navigation.lookAt(this.app.view.frameAll(side));
    this.app.invalidate();
  }

  private frameAll(): void {
    this.navigation.lookAt(this.app.view.frameAll());
    this.app.invalidate();
  }

  /// Shows all, unless the user has chosen another view.
  private frameAtFirst(): void {
    if (!this.navigation.hasMoved && !this.app.renderer.xr.isPresenting) this.frameAll();
  }

  private partLoaded(): void {
    // Without a scan the first frame shows the bodies.
    const hasLevels = this.model.mesh.length > 0;
    const hasParts = this.loader.objectsLoaded > 0 || (this.tiles?.stats.visible ?? 0) > 0;
    const isLoaded = hasLevels ? this.loader.level >= 0 : hasParts;
    if (!this.hasFirstFrame && isLoaded) {
      this.hasFirstFrame = true;
      this.frameAll();
    }
    if (this.loader.level >= 0) this.showDetail(this.loader.level);
    this.app.invalidate();
  }

  private showProgress({ loaded, total, what }: Progress): void {
    const bar = byId('progress', HTMLProgressElement);
    bar.value = total > 0 ? loaded / total : 1;
    bar.classList.toggle('done', what === '');
    const text = what === '' ? '' : `${what}: ${megabytes(loaded)} of ${megabytes(total)}`;
    setText(byId('loading-text', HTMLDivElement), text);
  }

  private frame(time: number, seconds: number): void {
    this.navigation.update(seconds);
    this.follow.update(seconds);
    if (this.isLinkRestored) this.link.update(time);
    if (this.linkPanel?.update()) this.showConnection();
    const state = this.app.session.latest();
    if (state) {
      if (!this.hadState) this.showFirstState();
      this.measuredState.add(state);
      this.restart.onState(state);
      this.robotPicture?.update(state.link);
      this.plot?.add(state, this.app.session.welcome?.objects ?? [], time / 1000);
      if (this.pulses >= 0 && state.pulses > this.pulses) navigator.vibrate?.(vibrationMs);
      this.pulses = state.pulses;
    }
    if (this.app.view.tool.animate(time / 1000, this.reducedMotion.matches)) this.app.invalidate();
    if (time - this.lastStats < 1000 * statsSeconds) return;
    this.lastStats = time;
    this.hud.update();
    this.showArm();
    this.objects.update(
      (body) => this.forceOn(body.object.name),
      (body) => this.comparisonOf(body.object.name),
    );
  }

  /// How far the arm is from a collision, or what it was stopped before.
  private showArm(): void {
    const state = this.isReplay ? null : (this.app.session.latest()?.arm ?? null);
    const line = byId('arm-line', HTMLOutputElement);
    const robot = this.model.robot;
    const names = this.app.session.welcome?.objects ?? [];
    const text = state && robot ? armText(state, robot, names) : '';
    line.hidden = text === '';
    line.classList.toggle('stopped', state?.isStopped ?? false);
    setText(line, text);
  }

  /// The tool appears with the first state: the first view has it too.
  private showFirstState(): void {
    this.hadState = true;
    const hasRobot = Boolean(this.app.session.latest()?.link);
    this.makePlot?.(hasRobot);
    if (hasRobot) this.expectMeasured();
    if (this.hasFirstFrame && !this.isReplay) this.frameAtFirst();
  }

  /// An operator's site shows what the robot's site measures.
  private expectMeasured(): void {
    this.enableLayer('ghosts');
    addTrackedLegend(this.legend, "outline: as the robot's site has it");
  }

  /// How the body's prediction compares with its tracking; null without any.
  private comparisonOf(name: string): Comparison | null {
    const index = this.app.session.welcome?.objects.indexOf(name) ?? -1;
    const state = this.app.session.latest();
    return state ? this.measuredState.compare(state, index) : null;
  }

  /// What a video says of the bodies that can be pushed.
  private caption(): Caption {
    const bodies = this.app.view.bodies.filter((body) => body.object.movable);
    const hasTracking = bodies.some((body) => body.ghost.visible);
    return {
      time: this.replay?.time ?? this.app.session.latest()?.worldTime ?? 0,
      tracked: hasTracking ? 'outline: tracked pose' : '',
      objects: bodies.map((body) => {
        const { name } = body.object;
        const error = this.replay?.error(name) ?? this.comparisonOf(name)?.error ?? NaN;
        const force = this.forceOn(name);
        return { name, phase: body.phase, label: phaseLabel(body), force, error };
      }),
    };
  }

  private forceOn(name: string): number {
    if (this.replay) return this.replay.force(name);
    const index = this.app.session.welcome?.objects.indexOf(name) ?? -1;
    const state = this.app.session.latest();
    if (!state) return this.hadState ? NaN : 0;
    return length(state.objects[index]?.force ?? [0]);
  }

  private drawn(): void {
    if (this.hasFirstFrame && Number.isNaN(this.hook.firstFrameTime))
      this.hook.firstFrameTime = performance.now();
    this.toolPanel?.update();
    this.labels.update(!this.app.renderer.xr.isPresenting); // beside the tool's ring
    this.measured.update(this.picking.points);
    this.linkPanel?.drawn();
  }
}
