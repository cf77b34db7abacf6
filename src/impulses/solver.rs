//! Impulses at many contacts at once, the one that needs it most first.
//!
//! A priority queue orders the contacts (Schmidl and Lin 2004, section 5: the deepest error first), and
//! every impulse re-keys the contacts of the two bodies that it changed. Two questions are answered so:
//!
//! * [`Problem::strike`]: impacts. Bodies collide one pair after the other, each with Newton's
//!   restitution against the speed of approach that it has by then, under Coulomb's cone, and no impact
//!   raises the kinetic energy. Five balls in a row pass one ball's motion on as they should.
//! * [`Problem::settle`]: forces over a stretch of time. Contacts remember their whole impulse and give
//!   back what is too much; a contact that sticks is held in both directions of its plane.
//!
//! What still approaches when the impulses are spent is merged into rigid clusters
//! by the stage, so that nothing does.

use glam::{Mat3, Vec3};

use super::energy;
use super::queue::Queue;
use crate::limits::IMPULSES_PER_CONTACT_MAX;
use crate::math;
use crate::state::rows::{Mover, Row};

/// Which contact gets the next impulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// The one whose velocity is most wrong.
    #[default]
    MostNegative,
    /// The one whose impulse takes the most energy.
    Energy,
    /// The lowest against gravity.
    BottomUp,
    /// One after the other, round and round.
    Sweep,
    /// Most negative first, eight a contact, then sweeps with steps along what they have in common (Silcowitz, Niebe and Erleben 2010, "A
    /// nonsmooth nonlinear conjugate gradient method for interactive contact force problems", algorithm 3).
    /// Impacts go as [`Order::Sweep`].
    Conjugate,
}

/// Bodies and their contacts. Ties are broken by the index of the row.
pub struct Problem<'a> {
    /// The bodies, indexed by the rows.
    pub movers: &'a mut [Mover],
    /// The contacts.
    pub rows: &'a mut [Row],
    /// Scratch: as many as movers.
    pub first: &'a mut [u32],
    /// Scratch: as many as rows.
    pub queue: &'a mut [u32],
    /// Which contact gets the next impulse.
    pub order: Order,
    /// Errors of velocity below this are none, in m/s.
    pub tolerance: f32,
}

/// Most impulses of a contact by the queue before [`Order::Conjugate`] sweeps.
const QUEUED_MAX: u32 = 8;

/// Most sweeps of [`Order::Conjugate`].
const SWEEPS_MAX: u32 = 16;

/// Most rounds of [`Problem::spread`]: something light between two hands takes ten.
const SPREADS_MAX: u32 = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Question {
    Strike,
    Settle,
}

impl Problem<'_> {
    /// Computes what the rows' impulses need and links the rows of each body. Call it before anything
    /// else, and again when masses or arms change. Cost: two small matrix products a row.
    pub fn prepare(&mut self) {
        for index in 0..self.rows.len() {
            let row = self.rows[index];
            self.first[row.body_a as usize] = 0;
            self.first[row.body_b as usize] = 0;
        }
        for index in (0..self.rows.len()).rev() {
            let mut row = self.rows[index];
            let (a, b) = (row.body_a as usize, row.body_b as usize);
            self.weigh(&mut row);
            row.next_a = self.first[a];
            self.first[a] = index as u32 + 1;
            row.next_b = self.first[b];
            self.first[b] = index as u32 + 1;
            row.pushes = 0;
            row.place = 0;
            self.rows[index] = row;
        }
    }

    /// Velocity of A's surface relative to B's at a contact, in m/s.
    #[inline]
    #[must_use]
    pub fn relative_velocity(&self, row: &Row) -> Vec3 {
        let a = self.movers[row.body_a as usize].velocity_at(row.arm_a);
        let b = self.movers[row.body_b as usize].velocity_at(row.arm_b);
        a + row.prescribed - b
    }

    /// Collides what approaches; how many impulses that took, at most `budget` and at most
    /// [`IMPULSES_PER_CONTACT_MAX`] a contact. Impulses add to [`Row::impulse`].
    pub fn strike(&mut self, budget: u32) -> u32 {
        self.strike_paid(&mut within(budget))
    }

    pub(super) fn strike_paid(&mut self, pay: Pay) -> u32 {
        self.answer(Question::Strike, pay)
    }

    /// Finds the impulses of a stretch of time that keep every contact at its target, starting from the
    /// rows' impulses, which are already in the movers' velocities ([`Problem::warm_start`]). Sweeps that come
    /// to no end, as between surfaces that jam, leave the share of them that feeds in no energy.
    pub fn settle(&mut self, budget: u32) -> u32 {
        self.settle_paid(&mut within(budget))
    }

    pub(super) fn settle_paid(&mut self, pay: Pay) -> u32 {
        self.answer(Question::Settle, pay)
    }

    /// Applies the rows' impulses to the movers.
    pub fn warm_start(&mut self) {
        for index in 0..self.rows.len() {
            let row = self.rows[index];
            if row.impulse != Vec3::ZERO {
                self.apply(&row, row.impulse);
            }
        }
    }

    /// Spreads impulses over whole manifolds, evenly, where none is known yet: what is pressed flat is
    /// pressed everywhere, where row after row would press one corner. How many impulses that took.
    pub fn spread(&mut self, budget: u32) -> u32 {
        self.spread_paid(&mut within(budget))
    }

    pub(super) fn spread_paid(&mut self, pay: Pay) -> u32 {
        let mut applied = 0;
        for _ in 0..SPREADS_MAX {
            let before = applied;
            let mut first = 0;
            while first < self.rows.len() {
                let end = self.end_of_manifold(first);
                if end - first > 1 && self.spread_one(first, end, pay) {
                    applied += 1;
                }
                first = end;
            }
            if applied == before {
                break;
            }
        }
        applied
    }

    /// One impulse at the middle of the manifold from `first` to `end`, if all of it approaches and none of
    /// its rows was given an impulse before.
    fn spread_one(&mut self, first: usize, end: usize, pay: Pay) -> bool {
        let rows = &self.rows[first..end];
        let known = rows
            .iter()
            .any(|row| row.pushes > 0 || row.target == f32::NEG_INFINITY);
        let count = (end - first) as f32;
        if known {
            return false;
        }
        let mut middle = Row {
            arm_a: Vec3::ZERO,
            arm_b: Vec3::ZERO,
            prescribed: Vec3::ZERO,
            impulse: Vec3::ZERO,
            target: 0.0,
            least: 0.0,
            ..rows[0]
        };
        for row in rows {
            middle.arm_a += row.arm_a / count;
            middle.arm_b += row.arm_b / count;
            middle.prescribed += row.prescribed / count;
            middle.target += row.target / count;
            middle.impulse += row.impulse;
        }
        self.weigh(&mut middle);
        let velocity = self.relative_velocity(&middle);
        if middle.target - velocity.dot(middle.normal) <= self.tolerance || !pay(1) {
            return false;
        }
        let whole = whole_impulse(&middle, velocity - middle.mobility * middle.impulse);
        let change = whole - middle.impulse;
        for row in &mut self.rows[first..end] {
            row.impulse = whole / count;
        }
        self.apply(&middle, change);
        true
    }

    /// Computes what a row's impulses need.
    fn weigh(&self, row: &mut Row) {
        let (a, b) = (row.body_a as usize, row.body_b as usize);
        row.mobility = self.movers[a].mobility(row.arm_a) + self.movers[b].mobility(row.arm_b);
        row.inverse = inverse(&row.mobility);
        row.along = row.normal.dot(row.mobility * row.normal);
    }

    /// The largest speed by which a contact that `counts` is below its target, in m/s.
    #[must_use]
    pub fn worst_approach(&self, counts: impl Fn(&Row) -> bool) -> f32 {
        let mut worst = 0.0;
        for row in self.rows.iter() {
            if counts(row) {
                let missing = row.target - self.relative_velocity(row).dot(row.normal);
                worst = math::max(worst, missing);
            }
        }
        worst
    }

    fn answer(&mut self, question: Question, pay: Pay) -> u32 {
        match (self.order, question) {
            (Order::Conjugate, Question::Settle) => {
                let applied = self.work_off(question, pay);
                if self.rows.iter().all(|row| row.pushes < QUEUED_MAX) {
                    return applied;
                }
                let swept = self.conjugate(pay);
                energy::keep_passive(self, |row| row.impulse != Vec3::ZERO);
                applied + swept
            }
            (Order::Sweep | Order::Conjugate, _) => self.sweep(question, pay),
            _ => self.work_off(question, pay),
        }
    }

    /// Sweeps that remember where they were going. Every sweep pushes every row; it ends when no row was
    /// off by more than the tolerance.
    fn conjugate(&mut self, pay: Pay) -> u32 {
        let mut applied = 0;
        let mut last = 0.0;
        for row in self.rows.iter_mut() {
            row.heading = Vec3::ZERO;
        }
        for sweep in 1..=SWEEPS_MAX {
            if !pay(self.rows.len() as u32) {
                break;
            }
            let worst = self.sweep_all();
            applied += self.rows.len() as u32;
            if worst <= self.tolerance || sweep == SWEEPS_MAX {
                break;
            }
            last = self.go_on(last);
        }
        applied
    }

    /// Pushes every row once; the largest error that was met.
    fn sweep_all(&mut self) -> f32 {
        let mut worst = 0.0;
        for index in 0..self.rows.len() {
            let row = self.rows[index];
            self.rows[index].before = row.impulse;
            worst = math::max(worst, self.error(&row, Question::Settle));
            if row.target > f32::NEG_INFINITY {
                self.settle_one(index);
            }
        }
        worst
    }

    /// Goes on along the heading, as far as the last sweeps agree; the square of the last sweep's change.
    fn go_on(&mut self, last: f32) -> f32 {
        let mut square = 0.0;
        for row in self.rows.iter() {
            square += (row.impulse - row.before).length_squared();
        }
        let share = if last > 0.0 { square / last } else { 2.0 };
        for index in 0..self.rows.len() {
            let row = self.rows[index];
            let change = row.impulse - row.before;
            if share > 1.0 {
                self.rows[index].heading = change;
            } else {
                let step = row.heading * share;
                self.rows[index].heading = step + change;
                if step != Vec3::ZERO {
                    self.rows[index].impulse = row.impulse + step;
                    self.apply(&row, step);
                }
            }
        }
        square
    }

    /// Pushes rows in turn until none needs it.
    fn sweep(&mut self, question: Question, pay: Pay) -> u32 {
        let mut applied = 0;
        for _ in 0..IMPULSES_PER_CONTACT_MAX {
            let before = applied;
            for index in 0..self.rows.len() {
                if self.error(&self.rows[index], question) > self.tolerance {
                    if !pay(1) {
                        return applied;
                    }
                    self.push(index, question);
                    applied += 1;
                }
            }
            if applied == before {
                break;
            }
        }
        applied
    }

    /// Pushes the first row of the queue until the queue is empty.
    fn work_off(&mut self, question: Question, pay: Pay) -> u32 {
        for index in 0..self.rows.len() {
            self.rows[index].key = self.key(index, question);
            self.rows[index].place = 0;
        }
        let mut queue = Queue::build(self.queue, self.rows);
        let mut applied = 0;
        while let Some(index) = queue.top(self.queue) {
            if !pay(1) {
                break;
            }
            self.push(index, question);
            applied += 1;
            let row = self.rows[index];
            self.rekey(&mut queue, index, question);
            for body in [row.body_a, row.body_b] {
                if self.movers[body as usize].is_movable() {
                    self.rekey_body(&mut queue, body, question);
                }
            }
        }
        applied
    }

    fn rekey_body(&mut self, queue: &mut Queue, body: u32, question: Question) {
        let mut next = self.first[body as usize];
        while let Some(index) = next.checked_sub(1) {
            let index = index as usize;
            self.rekey(queue, index, question);
            let row = &self.rows[index];
            next = if row.body_a == body {
                row.next_a
            } else {
                row.next_b
            };
        }
    }

    fn rekey(&mut self, queue: &mut Queue, index: usize, question: Question) {
        let key = self.key(index, question);
        queue.set(self.queue, self.rows, index, key);
    }

    /// How urgent a row is; zero when it needs nothing or had its share.
    fn key(&self, index: usize, question: Question) -> f32 {
        let row = &self.rows[index];
        let most = if self.order == Order::Conjugate && question == Question::Settle {
            QUEUED_MAX
        } else {
            IMPULSES_PER_CONTACT_MAX
        };
        if row.pushes >= most {
            return 0.0;
        }
        let error = self.error(row, question);
        if error <= self.tolerance {
            return 0.0;
        }
        match self.order {
            Order::MostNegative | Order::Sweep | Order::Conjugate => error,
            Order::Energy => error * error / math::max(row.along, 1e-20),
            Order::BottomUp => 1e4 - row.height,
        }
    }

    /// How far a row's velocity is from where an impulse would bring it, in m/s.
    fn error(&self, row: &Row, question: Question) -> f32 {
        let velocity = self.relative_velocity(row);
        let normal = velocity.dot(row.normal);
        match question {
            Question::Strike => wanted(row, normal) - normal,
            Question::Settle => settling_error(row, velocity, normal),
        }
    }

    fn push(&mut self, index: usize, question: Question) {
        self.rows[index].pushes += 1;
        match question {
            Question::Strike => self.strike_one(index),
            Question::Settle => self.settle_one(index),
        }
    }

    fn settle_one(&mut self, index: usize) {
        let row = self.rows[index];
        let free = self.relative_velocity(&row) - row.mobility * row.impulse;
        let whole = whole_impulse(&row, free);
        self.rows[index].impulse = whole;
        self.apply(&row, whole - row.impulse);
    }

    fn apply(&mut self, row: &Row, impulse: Vec3) {
        self.movers[row.body_a as usize].push(row.arm_a, impulse);
        self.movers[row.body_b as usize].push(row.arm_b, -impulse);
    }

    /// Collides at one row, or at the middle of all approaching rows of its manifold when they are
    /// several: what lands flat keeps its orientation, where corner after corner would turn it.
    fn strike_one(&mut self, index: usize) {
        let row = self.rows[index];
        let end = self.end_of_manifold(row.manifold as usize);
        let first = row.manifold as usize;
        if self.rows[index].pushes == 1 && end - first > 1 && self.strike_together(first, end) {
            return;
        }
        let fed = row.target > 0.0;
        let impulse = collision(&row, self.relative_velocity(&row), fed);
        self.rows[index].impulse += impulse;
        self.apply(&row, impulse);
    }

    fn end_of_manifold(&self, first: usize) -> usize {
        let mut end = first + 1;
        while end < self.rows.len() && self.rows[end].manifold as usize == first {
            end += 1;
        }
        end
    }

    /// One impulse at the middle of the approaching rows from `first` to `end`; whether there were two or
    /// more.
    fn strike_together(&mut self, first: usize, end: usize) -> bool {
        let mut middle = Row {
            arm_a: Vec3::ZERO,
            arm_b: Vec3::ZERO,
            prescribed: Vec3::ZERO,
            target: 0.0,
            ..self.rows[first]
        };
        let mut count = 0.0;
        for row in &self.rows[first..end] {
            let normal = self.relative_velocity(row).dot(row.normal);
            let wanted = wanted(row, normal);
            if wanted - normal > self.tolerance {
                middle.arm_a += row.arm_a;
                middle.arm_b += row.arm_b;
                middle.prescribed += row.prescribed;
                middle.target += wanted;
                count += 1.0;
            }
        }
        if count < 2.0 {
            return false;
        }
        middle.arm_a /= count;
        middle.arm_b /= count;
        middle.prescribed /= count;
        middle.target /= count;
        middle.bounce = f32::INFINITY;
        self.weigh(&mut middle);
        let fed = self.rows[first..end].iter().any(|row| row.target > 0.0);
        let impulse = collision(&middle, self.relative_velocity(&middle), fed);
        self.share_out(first..end, impulse / count);
        self.apply(&middle, impulse);
        true
    }

    /// Books an impulse at the rows that approach.
    fn share_out(&mut self, rows: core::ops::Range<usize>, share: Vec3) {
        for index in rows {
            let row = &self.rows[index];
            let normal = self.relative_velocity(row).dot(row.normal);
            if wanted(row, normal) - normal > self.tolerance {
                let row = &mut self.rows[index];
                row.impulse += share;
                row.pushes = row.pushes.max(1);
            }
        }
    }
}

/// Pays for so many impulses, all or none; whether it could.
type Pay<'p> = &'p mut dyn FnMut(u32) -> bool;

/// Pays for so many impulses in all.
fn within(budget: u32) -> impl FnMut(u32) -> bool {
    let mut left = budget;
    move |impulses| match left.checked_sub(impulses) {
        Some(rest) => {
            left = rest;
            true
        }
        None => false,
    }
}

/// The normal velocity that a collision brings a contact to.
fn wanted(row: &Row, normal_velocity: f32) -> f32 {
    if -normal_velocity <= row.bounce {
        return row.target;
    }
    // What has not come apart after half its impulses is not to bounce for ever.
    let lively = row.pushes < IMPULSES_PER_CONTACT_MAX / 2;
    let bounced = if lively {
        -row.restitution * normal_velocity
    } else {
        0.0
    };
    math::max(row.target, bounced)
}

/// The impulse of one collision: the one that also stops all sliding, or else the one on Coulomb's cone
/// against the slip (the paper's equation 10 alone reverses slip and can create energy). Where restitution
/// and friction together would raise the kinetic energy (Kane and Levinson 1985), first restitution goes,
/// then friction. Unless energy is fed in to take an overlap away.
fn collision(row: &Row, velocity: Vec3, fed: bool) -> Vec3 {
    let normal_velocity = velocity.dot(row.normal);
    let target = wanted(row, normal_velocity);
    let lacking = target - normal_velocity;
    if lacking <= 0.0 || row.along <= 0.0 {
        return Vec3::ZERO;
    }
    let whole = bounded(row, velocity, target);
    if fed || !raises_energy(row, velocity, whole) {
        return whole;
    }
    let plastic = bounded(row, velocity, math::min(target, 0.0));
    if !raises_energy(row, velocity, plastic) {
        return plastic;
    }
    row.normal * (lacking / row.along)
}

/// The change of kinetic energy by an impulse, j.v + j.K j / 2, is above rounding.
fn raises_energy(row: &Row, velocity: Vec3, impulse: Vec3) -> bool {
    let before = impulse.dot(velocity);
    before + 0.5 * impulse.dot(row.mobility * impulse) > 1e-6 * before.abs()
}

/// The impulse within Coulomb's cone that brings the normal velocity to `target`.
fn bounded(row: &Row, velocity: Vec3, target: f32) -> Vec3 {
    let n = row.normal;
    let sticking = row.inverse * (n * target - velocity);
    let push = sticking.dot(n);
    if push > 0.0 && is_in_cone(row, sticking, push) {
        return sticking;
    }
    sliding(row, velocity, target - velocity.dot(n))
}

fn is_in_cone(row: &Row, impulse: Vec3, push: f32) -> bool {
    let friction = row.friction * push;
    (impulse - row.normal * push).length_squared() <= friction * friction
}

/// The impulse on the cone, against the slip of `velocity`, that changes the normal velocity by
/// `lacking`.
fn sliding(row: &Row, velocity: Vec3, lacking: f32) -> Vec3 {
    let n = row.normal;
    let frictionless = n * (lacking / row.along);
    let Some(against) = math::direction(n * velocity.dot(n) - velocity) else {
        return frictionless;
    };
    let on_cone = n + against * row.friction;
    let gain = n.dot(row.mobility * on_cone);
    // Painleve: friction that jams the contact instead of opening it is left out.
    if gain <= 0.1 * row.along {
        return frictionless;
    }
    on_cone * (lacking / gain)
}

/// A contact's whole impulse, given its velocity without it.
///
/// Where the cone does not hold what would stick, friction goes on from what it was, against the slip that
/// is left: from impulse to impulse it turns until it opposes the slip that there will be.
fn whole_impulse(row: &Row, free: Vec3) -> Vec3 {
    let n = row.normal;
    let lacking = row.target - free.dot(n);
    if row.along <= 0.0 || (lacking <= 0.0 && row.least <= 0.0) {
        return Vec3::ZERO;
    }
    let impulse = if lacking > 0.0 {
        let sticking = row.inverse * (n * row.target - free);
        let push = sticking.dot(n);
        if push > 0.0 && is_in_cone(row, sticking, push) {
            sticking
        } else {
            slipping(row, free, lacking)
        }
    } else {
        Vec3::ZERO
    };
    if impulse.dot(n) >= row.least {
        impulse
    } else {
        pressed(row, free)
    }
}

/// The whole impulse of a contact that slips.
fn slipping(row: &Row, free: Vec3, lacking: f32) -> Vec3 {
    let n = row.normal;
    let velocity = free + row.mobility * row.impulse;
    let slip = velocity - n * velocity.dot(n);
    let held = row.impulse - n * row.impulse.dot(n);
    // At least as much as the slip changes for an impulse along it.
    let most = row.mobility.x_axis.x + row.mobility.y_axis.y + row.mobility.z_axis.z - row.along;
    let frictionless = n * (lacking / row.along);
    let Some(along) = math::direction(held - slip / math::max(most, 1e-20)) else {
        return frictionless;
    };
    let on_cone = n + along * row.friction;
    let gain = n.dot(row.mobility * on_cone);
    // Painleve: friction that jams the contact instead of opening it is left out.
    if gain <= 0.1 * row.along {
        return frictionless;
    }
    on_cone * (lacking / gain)
}

/// The impulse of a contact that is pressed by its least normal impulse, with as much friction as stops
/// the slip or as the cone allows.
fn pressed(row: &Row, free: Vec3) -> Vec3 {
    let push = row.normal * row.least;
    let velocity = free + row.mobility * push;
    let slip = velocity - row.normal * velocity.dot(row.normal);
    let Some(along) = math::direction(slip) else {
        return push;
    };
    let stops = math::length(slip) / along.dot(row.mobility * along);
    push - along * math::min(stops, row.friction * row.least)
}

/// How far a contact is from its target, in either direction when it can give back, and how fast it slips
/// though its friction could hold it, or another way than its friction pulls.
fn settling_error(row: &Row, velocity: Vec3, normal_velocity: f32) -> f32 {
    let push = row.impulse.dot(row.normal);
    let missing = row.target - normal_velocity;
    if push <= 0.0 {
        return if row.least > 0.0 { f32::MAX } else { missing };
    }
    let pressed = push <= row.least * (1.0 + 1e-5);
    let error = if pressed { missing } else { missing.abs() };
    let slip = velocity - row.normal * normal_velocity;
    let held = row.impulse - row.normal * push;
    let hold = 0.999 * row.friction * push;
    let astray = if held.length_squared() < hold * hold {
        math::length(slip)
    } else {
        let along = math::direction(held).map_or(Vec3::ZERO, |along| along * math::length(slip));
        math::length(slip + along)
    };
    math::max(error, astray)
}

fn inverse(matrix: &Mat3) -> Mat3 {
    let size = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    if matrix.determinant() > 1e-12 * size * size * size {
        matrix.inverse()
    } else {
        Mat3::ZERO
    }
}
