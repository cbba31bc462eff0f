//! A node that follows the rows of a topic: `/rows` in, `/bounds` out, both `std_msgs/Float64MultiArray`.
//!
//! `follow COLUMNS`, COLUMNS from 1 to 9, built by `cargo build --release --features ros` with ROS 2 sourced.

use futures::StreamExt;
use futures::executor::LocalPool;
use futures::task::LocalSpawnExt;
use onboard::Bounds;
use r2r::QosProfile;
use r2r::std_msgs::msg::Float64MultiArray;
use ros2_follow::Topic;
use std::time::Duration;

/// Most size of any parameter, with which the follower starts.
const START: f64 = 1e6;

type Failure = Box<dyn std::error::Error>;

fn node<const N: usize>() -> Result<(), Failure> {
    let context = r2r::Context::create()?;
    let mut node = r2r::Node::create(context, "follow", "")?;
    let mut rows = node.subscribe::<Float64MultiArray>("/rows", QosProfile::default())?;
    let bounds = node.create_publisher::<Float64MultiArray>("/bounds", QosProfile::default())?;
    let mut topic = Topic::<N>::new(Bounds::new(-START, START))?;
    let mut pool = LocalPool::new();
    pool.spawner().spawn_local(async move {
        while let Some(row) = rows.next().await {
            let answer = topic.answer(&row.data);
            let sent = answer.map(|data| Float64MultiArray { layout: row.layout, data });
            match sent.map(|message| bounds.publish(&message)) {
                Ok(Ok(())) => {}
                Ok(Err(error)) => eprintln!("follow: {error}"),
                Err(words) => eprintln!("follow: {words}"),
            }
        }
    })?;
    loop {
        node.spin_once(Duration::from_millis(10));
        pool.run_until_stalled();
    }
}

fn main() -> Result<(), Failure> {
    match std::env::args().nth(1).as_deref() {
        Some("1") => node::<1>(),
        Some("2") => node::<2>(),
        Some("3") => node::<3>(),
        Some("4") => node::<4>(),
        Some("5") => node::<5>(),
        Some("6") => node::<6>(),
        Some("7") => node::<7>(),
        Some("8") => node::<8>(),
        Some("9") => node::<9>(),
        _ => Err("give the number of parameters, 1 to 9, as in `follow 5`".into()),
    }
}
