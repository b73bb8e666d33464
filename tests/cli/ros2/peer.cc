// The other end of `asdic serve --ros2`, by another vendor's DDS (Fast DDS): publishes poses as ROS 2 does,
// receives pings, prints what is in them.
//
//     peer DOMAIN odometry|pose reliable|best_effort HZ FRAME OUT [FIRST_STAMP_NS]  < poses
//
// A line of the input is x y z qx qy qz qw. With HZ 0 every pose waits for its ping; else poses go out at
// that rate, and their pings are counted and timed. OUT: a folder for what images hold, one file each.
// PEER_WAIT_S: how long one waits for a ping, else 60. PEER_COLD: without poses beforehand. PEER_TOPICS: what it
// subscribes to, of sonar,image,detections,tf; pings are waited for on the image if it is among them, else on the
// sonar. PEER_CLOCKLESS: nothing on /clock. FIRST_STAMP_NS: poses say that and 0.1 s more each; without it the
// time at which they go out. PEER_UNTIMED: all of them say 0.
#include "asdic_rosPubSubTypes.h"

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

using namespace eprosima::fastdds::dds;
using Sonar = marine_acoustic_msgs::msg::dds_::ProjectedSonarImage_;
using SonarType = marine_acoustic_msgs::msg::dds_::ProjectedSonarImage_PubSubType;
using Image = sensor_msgs::msg::dds_::Image_;
using ImageType = sensor_msgs::msg::dds_::Image_PubSubType;
using Found = marine_acoustic_msgs::msg::dds_::SonarDetections_;
using FoundType = marine_acoustic_msgs::msg::dds_::SonarDetections_PubSubType;
using Transforms = tf2_msgs::msg::dds_::TFMessage_;
using TransformsType = tf2_msgs::msg::dds_::TFMessage_PubSubType;
using Pose = geometry_msgs::msg::dds_::PoseStamped_;
using PoseType = geometry_msgs::msg::dds_::PoseStamped_PubSubType;
using Odometry = nav_msgs::msg::dds_::Odometry_;
using OdometryType = nav_msgs::msg::dds_::Odometry_PubSubType;
using Clock = rosgraph_msgs::msg::dds_::Clock_;
using ClockType = rosgraph_msgs::msg::dds_::Clock_PubSubType;

static std::mutex lock;
static std::condition_variable news;
static std::map<int64_t, double> sent_s;                     // by stamp
static std::map<std::string, std::vector<double>> latency_s; // by topic
static std::string folder;
static bool is_quiet;
static size_t warm; // pings of poses that only prove that both ends have found one another

static double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

static int64_t stamp_of(const std_msgs::msg::dds_::Header_ &header) {
    return header.stamp_().sec_() * INT64_C(1000000000) + header.stamp_().nanosec_();
}

template <typename Message> static int64_t stamp_of(const Message &m) {
    return stamp_of(m.header_());
}

static int64_t stamp_of(const Transforms &m) {
    return stamp_of(m.transforms_().front().header_());
}

static void keep(const char *name, size_t number, const std::vector<uint8_t> &bytes) {
    std::ofstream file(folder + "/" + name + "_" + std::to_string(number), std::ios::binary);
    file.write(reinterpret_cast<const char *>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

static void show(const Sonar &m, size_t number) {
    const auto &image = m.image_();
    keep("sonar", number, image.data_());
    printf("\"frame\":\"%s\",\"frequency\":%.9g,\"sound_speed\":%.9g,\"tx\":%zu,\"rx\":[%zu,%.9g],"
           "\"dtype\":%u,\"beams\":%u,\"bytes\":%zu,\"ranges\":[%zu,%.9g,%.9g],\"directions\":[",
           m.header_().frame_id_().c_str(), m.ping_info_().frequency_(),
           m.ping_info_().sound_speed_(), m.ping_info_().tx_beamwidths_().size(),
           m.ping_info_().rx_beamwidths_().size(), m.ping_info_().rx_beamwidths_().front(),
           image.dtype_(), image.beam_count_(), image.data_().size(), m.ranges_().size(),
           m.ranges_().front(), m.ranges_().back());
    const char *comma = "";
    for (const auto &d : m.beam_directions_()) {
        printf("%s[%.17g,%.17g,%.17g]", comma, d.x_(), d.y_(), d.z_());
        comma = ",";
    }
    printf("]");
}

static void show(const Image &m, size_t number) {
    keep("image", number, m.data_());
    printf(
        "\"frame\":\"%s\",\"encoding\":\"%s\",\"height\":%u,\"width\":%u,\"step\":%u,\"bytes\":%zu",
        m.header_().frame_id_().c_str(), m.encoding_().c_str(), m.height_(), m.width_(), m.step_(),
        m.data_().size());
}

static void show(const Found &m, size_t) {
    printf("\"frame\":\"%s\",\"found\":[", m.header_().frame_id_().c_str());
    for (size_t i = 0; i < m.two_way_travel_times_().size(); i++) {
        printf("%s[%.9g,%.9g,%.9g]", i ? "," : "", m.two_way_travel_times_()[i], m.rx_angles_()[i],
               m.intensities_()[i]);
    }
    printf("]");
}

static void show(const Transforms &m, size_t) {
    const auto &only = m.transforms_().front();
    const auto &at = only.transform_().translation_();
    const auto &q = only.transform_().rotation_();
    printf("\"count\":%zu,\"frame\":\"%s\",\"child\":\"%s\",\"at\":[%.17g,%.17g,%.17g],"
           "\"q\":[%.17g,%.17g,%.17g,%.17g]",
           m.transforms_().size(), only.header_().frame_id_().c_str(),
           only.child_frame_id_().c_str(), at.x_(), at.y_(), at.z_(), q.x_(), q.y_(), q.z_(),
           q.w_());
}

template <typename Message> class Ears : public DataReaderListener {
  public:
    explicit Ears(const char *name) : name(name) {
    }
    void on_data_available(DataReader *reader) override {
        Message message;
        SampleInfo info;
        while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
            if (info.valid_data) {
                take(message);
            }
        }
    }

  private:
    void take(const Message &message) {
        double arrived_s = now_s();
        int64_t stamp = stamp_of(message);
        std::lock_guard<std::mutex> guard(lock);
        if (!sent_s.count(stamp)) {
            warm++;
            news.notify_all();
            return;
        }
        auto &times = latency_s[name];
        times.push_back(arrived_s - sent_s[stamp]);
        if (!is_quiet) {
            printf("{\"topic\":\"%s\",\"stamp\":%lld,", name, static_cast<long long>(stamp));
            show(message, times.size() - 1);
            printf("}\n");
            fflush(stdout);
        }
        news.notify_all();
    }
    const char *name;
};

// On the loopback alone, by UDP: what Cyclone DDS shares with it.
static DomainParticipant *join(int domain) {
    DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    udp->sendBufferSize = udp->receiveBufferSize = 4 << 20;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    eprosima::fastrtps::rtps::Locator_t here;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(here, "127.0.0.1");
    qos.wire_protocol().builtin.initialPeersList.push_back(here);
    return DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

class Node {
  public:
    Node(int domain, bool is_reliable) : is_reliable(is_reliable), participant(join(domain)) {
        if (!participant) {
            fprintf(stderr, "no participant\n");
            exit(1);
        }
        publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
        subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    }
    DataWriter *writer(const char *name, TypeSupport type) {
        DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
        qos.reliability().kind = BEST_EFFORT_RELIABILITY_QOS;
        qos.history().kind = KEEP_LAST_HISTORY_QOS;
        qos.history().depth = 5;
        return publisher->create_datawriter(topic(name, type), qos);
    }
    // RELIABLE in any case where the topic's readers are so by custom, as those of /tf.
    void reader(const char *name, TypeSupport type, DataReaderListener *ears,
                bool is_always_reliable = false) {
        DataReaderQos qos = DATAREADER_QOS_DEFAULT;
        qos.reliability().kind = is_reliable || is_always_reliable ? RELIABLE_RELIABILITY_QOS
                                                                   : BEST_EFFORT_RELIABILITY_QOS;
        qos.history().kind = KEEP_LAST_HISTORY_QOS;
        qos.history().depth = 5;
        qos.endpoint().history_memory_policy =
            eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
        subscriber->create_datareader(topic(name, type), qos, ears);
    }

  private:
    Topic *topic(const char *name, TypeSupport type) {
        type.register_type(participant);
        return participant->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
    }
    bool is_reliable;
    DomainParticipant *participant;
    Publisher *publisher;
    Subscriber *subscriber;
};

static void fill(std_msgs::msg::dds_::Header_ &header, int64_t stamp, const char *frame) {
    header.stamp_().sec_(static_cast<int32_t>(stamp / 1000000000));
    header.stamp_().nanosec_(static_cast<uint32_t>(stamp % 1000000000));
    header.frame_id_(frame);
}

static void fill(geometry_msgs::msg::dds_::Pose_ &pose, const double v[7]) {
    pose.position_().x_(v[0]);
    pose.position_().y_(v[1]);
    pose.position_().z_(v[2]);
    pose.orientation_().x_(v[3]);
    pose.orientation_().y_(v[4]);
    pose.orientation_().z_(v[5]);
    pose.orientation_().w_(v[6]);
}

static int64_t wall_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
}

// Median and 99th percentile, ms, of a topic.
static void report(const std::string &name, std::vector<double> times, double took_s,
                   size_t poses) {
    std::sort(times.begin(), times.end());
    size_t n = times.size();
    printf("{\"summary\":\"%s\",\"poses\":%zu,\"pings\":%zu,\"per_s\":%.3f,\"median_ms\":%.3f,"
           "\"p99_ms\":%.3f}\n",
           name.c_str(), poses, n, static_cast<double>(n) / took_s, n ? 1e3 * times[n / 2] : 0.0,
           n ? 1e3 * times[n * 99 / 100] : 0.0);
}

struct Sender {
    DataWriter *poses, *clock;
    bool is_odometry;
    const char *frame;
    void send(const double v[7], int64_t stamp, int32_t clock_s) {
        Clock time;
        Odometry odometry;
        Pose pose;
        time.clock_().sec_(clock_s);
        if (clock) {
            clock->write(&time);
        }
        fill(is_odometry ? odometry.header_() : pose.header_(), stamp, frame);
        fill(is_odometry ? odometry.pose_().pose_() : pose.pose_(), v);
        poses->write(is_odometry ? static_cast<void *>(&odometry) : static_cast<void *>(&pose));
    }
};

// Best effort forgets what it sends before the ends have found one another: the first pose goes out, long
// before its time, until there is a ping, and until no more come.
static void warm_up(Sender &sender, const double v[7], int64_t first_ns) {
    size_t had = 0;
    for (int i = 0; i < 240; i++) {
        sender.send(v, first_ns + (i - 1000) * INT64_C(1000000000), 1 + i);
        std::unique_lock<std::mutex> guard(lock);
        if (news.wait_for(guard, std::chrono::milliseconds(500), [&] { return warm > 0; })) {
            break;
        }
    }
    for (size_t now = warm; now != had;) {
        had = now;
        std::this_thread::sleep_for(std::chrono::milliseconds(1000));
        std::lock_guard<std::mutex> guard(lock);
        now = warm;
    }
}

int main(int argc, char **argv) {
    if (argc < 7) {
        return 2;
    }
    bool is_odometry = std::string(argv[2]) == "odometry";
    double hz = atof(argv[4]);
    const char *frame = argv[5];
    folder = argv[6];
    is_quiet = hz > 0.0;
    bool has_first = argc > 7, is_untimed = getenv("PEER_UNTIMED");
    int64_t first_ns = has_first ? atoll(argv[7]) : 0;
    Node node(atoi(argv[1]), std::string(argv[3]) == "reliable");
    Ears<Sonar> sonar("sonar");
    Ears<Image> image("image");
    Ears<Found> found("detections");
    Ears<Transforms> tf("tf");
    TypeSupport sonar_type(new SonarType), image_type(new ImageType), found_type(new FoundType);
    TypeSupport pose_type(is_odometry ? static_cast<TopicDataType *>(new OdometryType)
                                      : static_cast<TopicDataType *>(new PoseType));
    TypeSupport clock_type(new ClockType);
    const char *chosen = getenv("PEER_TOPICS");
    const std::string topics = chosen ? chosen : "sonar,image,detections,tf";
    auto wants = [&](const char *name) { return topics.find(name) != std::string::npos; };
    const char *awaited = wants("image") ? "image" : "sonar";
    if (wants("sonar")) {
        node.reader("rt/asdic/sonar", sonar_type, &sonar);
    }
    if (wants("image")) {
        node.reader("rt/asdic/image", image_type, &image);
    }
    if (wants("detections")) {
        node.reader("rt/asdic/detections", found_type, &found);
    }
    if (wants("tf")) {
        node.reader("rt/tf", TypeSupport(new TransformsType), &tf, true);
    }
    DataWriter *poses = node.writer("rt/asdic/pose", pose_type);
    DataWriter *clock = node.writer("rt/clock", clock_type);
    Sender sender = {poses, getenv("PEER_CLOCKLESS") ? nullptr : clock, is_odometry, frame};
    const char *patience = getenv("PEER_WAIT_S");
    double v[7], began_s = 0.0, wait_s = patience ? atof(patience) : 60.0;
    size_t count = 0;
    while (std::cin >> v[0] >> v[1] >> v[2] >> v[3] >> v[4] >> v[5] >> v[6]) {
        if (count == 0 && !getenv("PEER_COLD")) {
            warm_up(sender, v, has_first ? first_ns : wall_ns());
        }
        began_s = count ? began_s : now_s();
        int64_t stamp = is_untimed  ? 0
                        : has_first ? first_ns + static_cast<int64_t>(count) * 100000000
                                    : wall_ns();
        int32_t clock_s = static_cast<int32_t>(1000 + count);
        size_t had;
        {
            std::lock_guard<std::mutex> guard(lock);
            had = latency_s[awaited].size();
            sent_s[stamp] = sent_s[clock_s * INT64_C(1000000000)] = now_s();
        }
        sender.send(v, stamp, clock_s);
        count++;
        if (hz > 0.0) {
            std::this_thread::sleep_until(std::chrono::steady_clock::time_point(
                std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                    std::chrono::duration<double>(began_s + static_cast<double>(count) / hz))));
            continue;
        }
        for (double end_s = now_s() + wait_s; now_s() < end_s;) { // the same again, if it was lost
            std::unique_lock<std::mutex> guard(lock);
            if (news.wait_for(guard, std::chrono::milliseconds(500),
                              [&] { return latency_s[awaited].size() > had; })) {
                break;
            }
            guard.unlock();
            sender.send(v, stamp, clock_s);
        }
    }
    double took_s = now_s() - began_s;
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    std::lock_guard<std::mutex> guard(lock);
    for (const auto &topic : latency_s) {
        report(topic.first, topic.second, took_s, count);
    }
    fflush(stdout);
    _Exit(0); // whatever the DDS's threads are at
}
